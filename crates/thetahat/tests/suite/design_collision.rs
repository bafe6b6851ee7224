//! Designs among obstacles: a UR10 on a table beside a wall, checked by another way than the design's.

use std::path::Path;

use thetahat::design::Design;
use thetahat_testing::project;

type Vec3 = [f64; 3];
type Mat3 = [[f64; 3]; 3];

const MARGIN_MM: f64 = 20.0;
/// Where the wall stands, m; the robot reaches 1.3 m.
const WALL: f64 = 0.6;
/// Standard Denavit-Hartenberg parameters: d, a, alpha in degrees.
const DH: [[f64; 3]; 6] = [
    [0.1273, 0.0, 90.0],
    [0.0, -0.612, 0.0],
    [0.0, -0.5723, 0.0],
    [0.163941, 0.0, 90.0],
    [0.1157, 0.0, -90.0],
    [0.0922, 0.0, 0.0],
];
const LINKS: [&str; 6] =
    ["shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint", "wrist_1_joint", "wrist_2_joint", "wrist_3_joint"];
/// Capsules in the frames of their joints, which stand behind the length d, mm: both ends and the radius.
const CAPSULES: [(Vec3, Vec3, f64); 6] = [
    ([0.0, 0.0, -67.0], [0.0, 0.0, 0.0], 90.0),
    ([0.0, 0.0, 176.0], [-612.0, 0.0, 176.0], 75.0),
    ([0.0, 0.0, 40.0], [-572.0, 0.0, 40.0], 55.0),
    ([0.0, 0.0, -104.0], [0.0, 0.0, 0.0], 45.0),
    ([0.0, 0.0, -116.0], [0.0, 0.0, 0.0], 40.0),
    ([0.0, 0.0, -52.0], [0.0, 0.0, 158.0], 45.0),
];

fn design(motion: &str) -> Design {
    let capsules: Vec<String> = LINKS
        .iter()
        .zip(CAPSULES)
        .map(|(link, (from, to, radius))| {
            format!("{{ link = '{link}', from = {from:?}, to = {to:?}, radius = {radius:?} }}")
        })
        .collect();
    let text = format!(
        "title = 'ur10'\nrobot = 'ur10.toml'\nduration_s = 6\nsample_rate_hz = 125\n[motion]\n{motion}\nstarts = 1\n\
         start = [0, -90, 0, -90, 0, 0]\n[limits]\nposition = [[-180, 180], [-200, 20], [-155, 155], [-180, 180], [-180, 180], \
         [-180, 180]]\nvelocity = [120, 120, 180, 180, 180, 180]\nacceleration = 300\n[noise]\n\
         torque = [3, 3, 2, 0.7, 0.7, 0.7]\n[signal]\ncutoff_hz = 8\ndecimation = 5\n[collision]\nmargin = {MARGIN_MM}\n\
         home = [0, -60, 60, -90, 0, 0]\ncapsules = [{}]\nignore = [['shoulder_pan_joint', 'table']]\n\
         [[collision.obstacles]]\nkind = 'plane'\nname = 'table'\nnormal = [0, 0, 1]\n\
         [[collision.obstacles]]\nkind = 'plane'\nname = 'wall'\npoint = [0, {}, 0]\nnormal = [0, -1, 0]\n",
        capsules.join(", "),
        1e3 * WALL
    );
    Design::parse(&text, &project("robots/ur10.toml").with_file_name("design.toml")).unwrap()
}

fn times(r: &Mat3, x: Vec3) -> Vec3 {
    r.map(|row| row.iter().zip(x).map(|(a, b)| a * b).sum())
}

fn product(a: &Mat3, b: &Mat3) -> Mat3 {
    a.map(|row| [0, 1, 2].map(|j| (0..3).map(|k| row[k] * b[k][j]).sum()))
}

fn plus(a: Vec3, b: Vec3) -> Vec3 {
    [0, 1, 2].map(|k| a[k] + b[k])
}

/// Points of the capsules' segments in the base, by the formula of Denavit and Hartenberg.
fn points(q: &[f64], parts: usize) -> Vec<Vec<Vec3>> {
    let (mut rotation, mut origin) = ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0; 3]);
    let mut all = Vec::new();
    for (j, [d, a, alpha]) in DH.into_iter().enumerate() {
        let ((s, c), (sa, ca)) = (q[j].sin_cos(), alpha.to_radians().sin_cos());
        rotation = product(&rotation, &[[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]);
        let (from, to, _) = CAPSULES[j];
        let point = |k: usize| {
            let part = k as f64 / parts as f64;
            let own = [0, 1, 2].map(|i| 1e-3 * (from[i] + part * (to[i] - from[i])));
            plus(origin, times(&rotation, plus(own, [0.0, 0.0, d])))
        };
        all.push((0..=parts).map(point).collect());
        origin = plus(origin, times(&rotation, [a, 0.0, d]));
        rotation = product(&rotation, &[[1.0, 0.0, 0.0], [0.0, ca, -sa], [0.0, sa, ca]]);
    }
    all
}

/// The least distance of capsules that are no neighbours, of the table and of the wall, m: points are tried.
fn least(q: &[f64]) -> f64 {
    let all = points(q, 24);
    let radius = |i: usize| 1e-3 * CAPSULES[i].2;
    let mut least = f64::INFINITY;
    for (i, first) in all.iter().enumerate() {
        for (j, second) in all.iter().enumerate().skip(i + 2) {
            for a in first {
                for b in second {
                    let square: f64 = (0..3).map(|k| (a[k] - b[k]).powi(2)).sum();
                    least = least.min(square.sqrt() - radius(i) - radius(j));
                }
            }
        }
        for point in first {
            least = least.min(WALL - point[1] - radius(i));
            if i > 0 {
                least = least.min(point[2] - radius(i));
            }
        }
    }
    least
}

/// No capsule is nearer to another, to the table or to the wall than the margin, at 1 kHz; and the design uses the room.
fn keeps_apart(motion: &str) {
    let design = design(motion);
    let results = design.run(2).unwrap();
    let collision = results.collision.as_ref().unwrap();
    let nearest = collision.pairs[0].distance;
    assert!(nearest >= 1e-3 * MARGIN_MM, "{collision:?}");
    // The trajectory is written at 125 Hz: cubic pieces between its samples are the motion at 1 kHz to a micrometre.
    let mut tried = f64::INFINITY;
    for k in 0..results.q.len() - 1 {
        for part in 0..8 {
            let t = f64::from(part) / 8.0;
            let q: Vec<f64> = (0..6).map(|j| cubic(&results, k, j, t)).collect();
            tried = tried.min(least(&q));
        }
    }
    println!(
        "{motion}: nearest {:.2} mm, by points that are tried {:.2} mm; searches {:?}",
        1e3 * nearest,
        1e3 * tried,
        results.starts
    );
    // Points that are tried are at most 26 mm apart: across the sum of two radii they miss two millimetres at most.
    assert!(tried >= nearest - 1e-5 && tried < nearest + 2e-3, "{tried} {nearest}");
    assert!(nearest < 1e-3 * MARGIN_MM + 0.02, "{nearest}");
}

/// The position of a joint between two samples, with their velocities.
fn cubic(results: &thetahat::results::DesignResults, k: usize, j: usize, t: f64) -> f64 {
    let step = 1.0 / results.sample_rate_hz;
    let at = |series: &thetahat::Series, k: usize| series.sample(k)[j];
    let (q0, q1) = (at(&results.q, k), at(&results.q, k + 1));
    let (v0, v1) = (step * at(&results.dq, k), step * at(&results.dq, k + 1));
    let (t2, t3) = (t * t, t * t * t);
    q0 * (2.0 * t3 - 3.0 * t2 + 1.0) + v0 * (t3 - 2.0 * t2 + t) + q1 * (3.0 * t2 - 2.0 * t3) + v1 * (t3 - t2)
}

#[test]
#[ignore = "long, each night"]
fn a_series_of_a_ur10_keeps_apart() {
    keeps_apart("harmonics = 3");
}

#[test]
#[ignore = "long, each night"]
fn moves_of_a_ur10_keep_apart() {
    keeps_apart("kind = 'moves'\nmoves = 6");
}

/// Shapes of a URDF: capsules around its boxes and cylinders, and meshes that are named.
#[test]
fn shapes_come_from_the_urdf() {
    let folder = thetahat_testing::Folder::new();
    let link = |name: &str, geometry: &str| {
        format!(
            "<link name='{name}'><inertial><origin xyz='0.2 0 0'/><mass value='2'/><inertia ixx='0.01' ixy='0' ixz='0' iyy='0.05' \
             iyz='0' izz='0.05'/></inertial><collision><origin xyz='0.2 0 0' rpy='0 1.5708 0'/><geometry>{geometry}</geometry></collision></link>"
        )
    };
    let joint = |name: &str, parent: &str, child: &str, x: f64| {
        format!(
            "<joint name='{name}' type='revolute'><parent link='{parent}'/><child link='{child}'/><origin xyz='{x} 0 0'/>\
             <axis xyz='0 1 0'/><limit lower='-2' upper='2' velocity='3' effort='50'/><dynamics friction='1' damping='1'/></joint>"
        )
    };
    let text = format!(
        "<robot name='arm'><link name='base'/>{}{}{}{}{}{}</robot>",
        link("upper", "<cylinder radius='0.05' length='0.4'/>"),
        link("lower", "<box size='0.08 0.08 0.4'/>"),
        link("hand", "<mesh filename='hand.stl'/>"),
        joint("one", "base", "upper", 0.0),
        joint("two", "upper", "lower", 0.4),
        joint("three", "lower", "hand", 0.4),
    );
    folder.write("arm.urdf", text);
    let text = "title = 'arm'\nrobot = 'arm.urdf'\nduration_s = 4\nsample_rate_hz = 500\n[motion]\nharmonics = 3\nstarts = 1\n\
        [limits]\nacceleration = 900\n[noise]\ntorque = 0.1\n[signal]\ncutoff_hz = 40\ndecimation = 10\n[collision]\nmargin = 10\n\
        [[collision.obstacles]]\nkind = 'box'\nname = 'post'\ncentre = [0, 0, -700]\nedges = [200, 200, 200]\n";
    let design = Design::parse(text, &folder.path().join("design.toml")).unwrap();
    let results = design.run(2).unwrap();
    let collision = results.collision.unwrap();
    assert_eq!(collision.uncovered, ["hand"]);
    let names: Vec<&str> = collision.pairs.iter().map(|p| p.first.as_str()).collect();
    assert!(names.contains(&"upper") && names.contains(&"lower") && !names.contains(&"hand"), "{names:?}");
    assert!(collision.pairs.iter().all(|p| p.distance >= 0.01), "{:?}", collision.pairs);
    let nothing = text.replace("[[collision.obstacles]]", "[[collision.none]]");
    assert!(Design::parse(&nothing, Path::new("design.toml")).is_err());
}
