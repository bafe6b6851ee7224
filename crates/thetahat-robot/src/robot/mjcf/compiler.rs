//! The settings of `<compiler>` that change the model.

use super::{
    element::{Attribute, Element},
    error::MjcfError,
};

/// Which bodies have their inertia from geoms.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum FromGeoms {
    /// Those without `<inertial>`.
    Auto,
    Always,
    Never,
}

/// The settings of all `<compiler>` elements together: later ones replace earlier ones.
pub(super) struct Settings {
    pub(super) degrees: bool,
    pub(super) limits_from_ranges: bool,
    /// Letters of the axes of euler angles.
    pub(super) euler: [char; 3],
    pub(super) from_geoms: FromGeoms,
    /// The groups of geoms that have mass.
    pub(super) groups: [f64; 2],
    pub(super) balances: bool,
    pub(super) least_mass: f64,
    pub(super) least_inertia: f64,
    pub(super) total_mass: Option<f64>,
}

impl Settings {
    pub(super) fn read(root: Element<'_>) -> Result<Self, MjcfError> {
        let mut settings = Self {
            degrees: true,
            limits_from_ranges: true,
            euler: ['x', 'y', 'z'],
            from_geoms: FromGeoms::Auto,
            groups: [0.0, 5.0],
            balances: false,
            least_mass: 0.0,
            least_inertia: 0.0,
            total_mass: None,
        };
        root.named("compiler").try_for_each(|compiler| settings.update(compiler))?;
        Ok(settings)
    }

    fn update(&mut self, compiler: Element<'_>) -> Result<(), MjcfError> {
        let flag = |key, usual: bool| match compiler.attribute(key) {
            Some(attribute) => Ok::<bool, MjcfError>(attribute.flag()?.unwrap_or(usual)),
            None => Ok(usual),
        };
        let number = |key, usual: f64| compiler.attribute(key).map_or(Ok(usual), Attribute::number);
        refuse_global(compiler)?;
        self.degrees = is_degrees(compiler)?.unwrap_or(self.degrees);
        self.limits_from_ranges = flag("autolimits", self.limits_from_ranges)?;
        self.balances = flag("balanceinertia", self.balances)?;
        self.euler = euler(compiler)?.unwrap_or(self.euler);
        self.from_geoms = from_geoms(compiler)?.unwrap_or(self.from_geoms);
        self.groups = compiler.attribute("inertiagrouprange").map_or(Ok(self.groups), Attribute::numbers)?;
        self.least_mass = number("boundmass", self.least_mass)?;
        self.least_inertia = number("boundinertia", self.least_inertia)?;
        let total = compiler.attribute("settotalmass").map(Attribute::number).transpose()?;
        self.total_mass = total.or(self.total_mass);
        Ok(())
    }

    /// An angle of the file in rad.
    pub(super) fn angle(&self, angle: f64) -> f64 {
        if self.degrees { angle.to_radians() } else { angle }
    }
}

fn refuse_global(compiler: Element<'_>) -> Result<(), MjcfError> {
    match compiler.attribute("coordinate") {
        Some(coordinate) if coordinate.text != "local" => {
            Err(coordinate.wrong("local: MuJoCo 2.3.3 and older convert global coordinates by saving the model"))
        }
        Some(_) | None => Ok(()),
    }
}

fn is_degrees(compiler: Element<'_>) -> Result<Option<bool>, MjcfError> {
    let Some(angle) = compiler.attribute("angle") else { return Ok(None) };
    match angle.text {
        "degree" => Ok(Some(true)),
        "radian" => Ok(Some(false)),
        _ => Err(angle.wrong("degree or radian")),
    }
}

fn from_geoms(compiler: Element<'_>) -> Result<Option<FromGeoms>, MjcfError> {
    let Some(attribute) = compiler.attribute("inertiafromgeom") else { return Ok(None) };
    Ok(Some(match attribute.flag()? {
        None => FromGeoms::Auto,
        Some(true) => FromGeoms::Always,
        Some(false) => FromGeoms::Never,
    }))
}

fn euler(compiler: Element<'_>) -> Result<Option<[char; 3]>, MjcfError> {
    let Some(attribute) = compiler.attribute("eulerseq") else { return Ok(None) };
    let letters: Vec<char> = attribute.text.chars().filter(|letter| "xyzXYZ".contains(*letter)).collect();
    match <[char; 3]>::try_from(letters) {
        Ok(letters) if attribute.text.len() == letters.len() => Ok(Some(letters)),
        Ok(_) | Err(_) => Err(attribute.wrong("three letters of x y z X Y Z")),
    }
}
