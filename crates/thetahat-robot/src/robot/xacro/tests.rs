use std::path::PathBuf;

use thetahat_testing::Folder;

use super::{ExpressionError, XacroError, XacroOptions, XacroProblem, expand_xacro, reference_cases::CASES};
use crate::robot::{RobotError, RobotSource, UrdfError, parse_xml};

const HEAD: &str = "<robot name=\"r\" xmlns:xacro=\"http://www.ros.org/wiki/xacro\">\n";

fn expand(body: &str) -> Result<String, XacroError> {
    let folder = Folder::new();
    folder.write("a/b/robot.xacro", format!("{HEAD}{body}</robot>"));
    expand_xacro(&folder.at("a/b/robot.xacro"), &XacroOptions::default()).map(|expanded| expanded.text)
}

fn problem(body: &str) -> (usize, XacroProblem) {
    let error = expand(body).unwrap_err();
    let XacroError::Element { place, problem } = error else { panic!("{error}") };
    (place.line, *problem)
}

fn says(body: &str, words: &[&str]) {
    let message = expand(body).unwrap_err().to_string();
    words.iter().for_each(|word| assert!(message.contains(word), "`{word}` is not in: {message}"));
}

/// The elements of a text with sorted attributes and trimmed texts.
fn canonical(text: &str) -> String {
    fn write(node: roxmltree::Node<'_, '_>) -> String {
        let mut attributes: Vec<String> = node.attributes().map(|a| format!(" {}={:?}", a.name(), a.value())).collect();
        attributes.sort();
        let child = |child: roxmltree::Node<'_, '_>| match child.text().filter(|_| child.is_text()) {
            Some(text) => text.trim().to_owned(),
            None if child.is_element() => write(child),
            None => String::new(),
        };
        let content: String = node.children().map(child).collect();
        format!("<{}{}>{content}</>\n", node.tag_name().name(), attributes.concat())
    }
    write(parse_xml(text, "canonical.urdf".as_ref()).unwrap().root_element())
}

#[test]
fn expansions_are_those_of_the_reference() {
    for case in CASES {
        let folder = Folder::new();
        case.files.iter().for_each(|(path, text)| _ = folder.write(path, text));
        let mut options = XacroOptions::default();
        case.arguments.iter().for_each(|text| options.add_argument(text).unwrap());
        let expanded = expand_xacro(&folder.at("robot.xacro"), &options);
        let expanded = expanded.unwrap_or_else(|error| panic!("{}: {error}", case.name));
        assert_eq!(canonical(&expanded.text), canonical(case.expected), "{}", case.name);
        assert!(expanded.paths.starts_with(&[folder.at("robot.xacro")]));
    }
}

#[test]
fn a_source_lists_the_files_and_gives_the_robot() {
    let case = CASES.iter().find(|case| case.name == "arm").unwrap();
    let folder = Folder::new();
    let text = case.files[0].1.replace("<link name=\"${prefix}base\"/>", "<xacro:include filename=\"base.xacro\"/>");
    folder.write("arm.xacro", &text);
    folder.write("base.xacro", format!("{HEAD}<link name=\"${{prefix}}base\"/></robot>"));
    let mut options = XacroOptions::default();
    options.add_argument("prefix:=left_").unwrap();
    let source = RobotSource::read_with_xacro(&folder.at("arm.xacro"), &options).unwrap();
    let names: Vec<String> = source.files().into_iter().map(|file| file.name).collect();
    assert_eq!(names, ["arm.xacro", "base.xacro"]);
    let robot = source.robot().unwrap();
    assert_eq!(robot.joints.iter().map(|j| j.name.as_str()).collect::<Vec<_>>(), ["left_j1", "left_j2"]);
    // A file without the extension is known by its namespace, and one that a TOML names by either.
    folder.write("arm.urdf", &text);
    folder.write("arm.toml", "urdf = \"arm.xacro\"\n[parameters]\nia1 = 0.2\n");
    assert_eq!(RobotSource::read(&folder.at("arm.urdf")).unwrap().robot().unwrap().joints[0].name, "j1");
    let on_xacro = RobotSource::read(&folder.at("arm.toml")).unwrap();
    assert_eq!((on_xacro.format(), on_xacro.files().len()), ("TOML on URDF", 3));
    let kept = RobotSource::from_text(on_xacro.to_text(), "results.json".as_ref()).unwrap();
    assert_eq!(kept.robot().unwrap().joints, on_xacro.robot().unwrap().joints);
}

#[test]
fn an_error_of_the_expanded_robot_says_that_it_is_expanded() {
    let folder = Folder::new();
    folder.write("arm.xacro", format!("{HEAD}<link name=\"${{'a'}}\"/></robot>"));
    let error = RobotSource::read(&folder.at("arm.xacro")).unwrap().robot().unwrap_err();
    assert!(matches!(error, RobotError::Urdf(UrdfError::NoMovingJoint { .. })));
    assert!(error.to_string().contains("arm.xacro (expanded): "), "{error}");
}

#[test]
fn texts_that_have_no_value_are_refused_with_line_and_remedy() {
    says(
        "<link name=\"${a + 1}\"/>",
        &["robot.xacro, line 2: <link name=\"${a + 1}\">", "no property `a` is defined here"],
    );
    says("<l x=\"${1 +}\"/>", &["line 2", "column 4", "expected a value, found the end"]);
    says("<l x=\"${1 / 0}\"/>", &["a division by zero"]);
    says("<l x=\"${'a' - 1}\"/>", &["`-` does not take text and a number"]);
    says("<l x=\"${sqrt(-1)}\"/>", &["sqrt takes a number at which it has a finite value"]);
    says("<l x=\"${[1][3]}\"/>", &["a list has no entry `3`"]);
    says("<l x=\"${open('/etc/passwd')}\"/>", &["no property `open`"]);
    says("<l x=\"${[i for i in range(3)]}\"/>", &["a list made by `for`", "one by one"]);
    says("<l x=\"${1\"/>", &["`${` is not closed"]);
    says("<l x=\"$(arg k)\"/>", &["argument `k` has no value", "--xacro-arg k:=VALUE"]);
    says("<l x=\"$(find other)\"/>", &["package `other` was not found", "--package other=DIR"]);
    says("<l x=\"$(env HOME)\"/>", &["the environment is not read", "--xacro-arg"]);
    says("<l x=\"$(optenv HOME)\"/>", &["the environment is not read"]);
    says("<l x=\"${xacro.fatal('no such gripper')}\"/>", &["the file says: no such gripper"]);
    says(
        "<xacro:property name=\"a\" value=\"${b}\"/><xacro:property name=\"b\" value=\"${a}\"/>\n<l x=\"${a}\"/>",
        &["line 3", "property `a` is defined by itself"],
    );
}

#[test]
fn elements_that_cannot_be_expanded_are_refused() {
    assert!(matches!(problem("\n<xacro:leg/>"), (3, XacroProblem::UnknownMacro { .. })));
    let leg = "<xacro:macro name=\"leg\" params=\"a *b\"><xacro:insert_block name=\"b\"/></xacro:macro>\n";
    let call = |call: &str| problem(&format!("{leg}{call}"));
    assert!(matches!(call("<xacro:leg c=\"1\"/>"), (3, XacroProblem::UnknownParameter { .. })));
    let (3, XacroProblem::MissingParameters { missing, .. }) = call("<xacro:leg/>") else { panic!() };
    assert_eq!(missing, ["a", "*b"]);
    assert!(matches!(call("<xacro:leg a=\"1\"><x/><y/></xacro:leg>"), (3, XacroProblem::UnusedBlock { .. })));
    assert!(matches!(problem("<xacro:insert_block name=\"b\"/>"), (2, XacroProblem::UnknownBlock { .. })));
    assert!(matches!(problem("<xacro:if value=\"maybe\"/>"), (2, XacroProblem::Value { attribute: "value", .. })));
    assert!(matches!(problem("<xacro:if/>"), (2, XacroProblem::Missing { .. })));
    assert!(matches!(problem("<xacro:property name=\"2a\" value=\"1\"/>"), (2, XacroProblem::Value { .. })));
    assert!(matches!(problem("<xacro:include filename=\"*.xacro\"/>"), (2, XacroProblem::Pattern { .. })));
    assert!(matches!(problem("<xacro:include filename=\"absent.xacro\"/>"), (2, XacroProblem::File { .. })));
    assert!(matches!(expand("<link"), Err(XacroError::Xml(UrdfError::Syntax { line: 2, .. }))));
}

#[test]
fn what_contains_itself_is_refused() {
    let macros =
        "<xacro:macro name=\"a\"><xacro:b/></xacro:macro><xacro:macro name=\"b\"><xacro:a/></xacro:macro><xacro:a/>";
    assert!(matches!(problem(macros), (2, XacroProblem::TooDeep { .. })));
    assert!(matches!(problem("<xacro:include filename=\"robot.xacro\"/>").1, XacroProblem::TooDeep { .. }));
    let nested = format!("{}{}", "<a>".repeat(5000), "</a>".repeat(5000));
    assert!(matches!(expand(&nested), Err(XacroError::Reading { .. })));
    let properties: String =
        (0..1000).map(|k| format!("<xacro:property name=\"p{k}\" value=\"${{p{} + 1}}\"/>", k + 1)).collect();
    assert!(expand(&format!("{properties}<l x=\"${{p0}}\"/>")).is_err());
}

#[test]
fn what_grows_without_end_is_refused() {
    let doubling: String = (0..40)
        .map(|k| format!("<xacro:macro name=\"m{k}\"><xacro:m{0}/><xacro:m{0}/></xacro:macro>", k + 1))
        .collect();
    let body = format!("{doubling}<xacro:macro name=\"m40\"><l/></xacro:macro><xacro:m0/>");
    assert!(matches!(problem(&body), (2, XacroProblem::TooLarge { .. })));
    let text =
        |text: &str| matches!(problem(text).1, XacroProblem::Text { error: ExpressionError::TooLarge { .. }, .. });
    assert!(text("<l x=\"${'a' * 10 ** 9}\"/>"));
    assert!(text(&format!("<l x=\"${{{}1}}\"/>", "1 + ".repeat(1000))));
    assert!(text(&format!("<l x=\"${{{}1{}}}\"/>", "(".repeat(100), ")".repeat(100))));
    let texts: String =
        (0..40).map(|k| format!("<xacro:property name=\"t{k}\" value=\"${{t{0}}}${{t{0}}}\"/>", k + 1)).collect();
    assert!(text(&format!("{texts}<xacro:property name=\"t40\" value=\"text\"/><l x=\"${{t0}}\"/>")));
    assert!(matches!(
        problem("<l x=\"${2 ** 100}\"/>").1,
        XacroProblem::Text { error: ExpressionError::NoNumber { .. }, .. }
    ));
}

/// Files that would take hours or more memory than there is.
#[test]
fn costs_are_bounded() {
    let large = "a".repeat(1 << 19);
    let copies = format!("<xacro:property name=\"t\" value=\"{large}\"/>{}", "<l x=\"${t}\"/>".repeat(1000));
    assert!(matches!(problem(&copies).1, XacroProblem::TooLarge { what: "bytes of values", .. }));
    let long = format!("<l x=\"${{{}}}\"/>", "1 ".repeat(1 << 20));
    assert!(matches!(problem(&long).1, XacroProblem::Text { .. }));
    let parameters = format!("<xacro:macro name=\"m\" params=\"{}\"/>", "p:=1 ".repeat(2000));
    assert!(matches!(problem(&parameters).1, XacroProblem::TooLarge { what: "parameters of a macro", .. }));
    let given = (0..2000).map(|k| format!("<xacro:attribute name=\"a{k}\" value=\"1\"/>")).collect::<String>();
    assert!(matches!(problem(&format!("<l>{given}</l>")).1, XacroProblem::TooLarge { .. }));
    let list = "<xacro:property name=\"l0\" value=\"${list(range(10**6))}\"/>".to_owned();
    let sums: String = (0..200).map(|_| "<l x=\"${len(l0 + l0)}\"/>".to_owned()).collect();
    assert!(expand(&format!("{list}{sums}")).is_err());
}

#[test]
fn files_outside_of_the_robots_folders_are_not_read() {
    let folder = Folder::new();
    let elsewhere = Folder::new();
    elsewhere.write("secret.xacro", format!("{HEAD}</robot>"));
    let other = elsewhere.path();
    let include = |path: &str| format!("{HEAD}<xacro:include filename=\"{path}\"/></robot>");
    folder.write("a/package.xml", "<package><name>a</name></package>");
    folder.write("a/urdf/robot.xacro", include("../../secret.xacro"));
    folder.write("secret.xacro", format!("{HEAD}</robot>"));
    let path = folder.at("a/urdf/robot.xacro");
    let refused = |options: &XacroOptions| {
        let error = expand_xacro(&path, options).unwrap_err();
        let XacroError::Element { problem, .. } = error else { panic!("{error}") };
        matches!(*problem, XacroProblem::Outside { .. })
    };
    assert!(refused(&XacroOptions::default()));
    folder.write("a/urdf/robot.xacro", include(&other.join("secret.xacro").display().to_string()));
    assert!(refused(&XacroOptions::default()));
    let mut options = XacroOptions::default();
    options.add_package(&format!("other={}", other.display())).unwrap();
    assert!(expand_xacro(&path, &options).is_ok());
    folder.write("a/urdf/robot.xacro", include("$(find other)/secret.xacro"));
    assert!(expand_xacro(&path, &options).is_ok());
}

/// A workspace of ROS may link to the files of its packages.
#[cfg(unix)]
#[test]
fn a_file_that_is_a_link_reads_the_package_it_is_in() {
    let folder = Folder::new();
    folder.write("src/arm/package.xml", "<package><name>arm</name></package>");
    folder.write("src/arm/urdf/arm.xacro", format!("{HEAD}<xacro:include filename=\"part.xacro\"/></robot>"));
    folder.write("src/arm/urdf/part.xacro", format!("{HEAD}<part/></robot>"));
    folder.write("install/share/arm/package.xml", "<package><name>arm</name></package>");
    folder.write("install/share/arm/urdf/other", "");
    for name in ["arm.xacro", "part.xacro"] {
        let (real, link) = (folder.at("src/arm/urdf").join(name), folder.at("install/share/arm/urdf").join(name));
        std::os::unix::fs::symlink(real, link).unwrap();
    }
    let expanded = expand_xacro(&folder.at("install/share/arm/urdf/arm.xacro"), &XacroOptions::default()).unwrap();
    assert!(expanded.text.contains("<part/>"));
}

#[test]
fn options_have_a_form() {
    let mut options = XacroOptions::default();
    assert!(matches!(options.add_argument("a=1"), Err(XacroError::Option { .. })));
    assert!(matches!(options.add_package("=x"), Err(XacroError::Option { .. })));
    options.add_argument("a:=b:=c").unwrap();
    options.add_package("arm=x/y").unwrap();
    assert_eq!(options.arguments, [("a".to_owned(), "b:=c".to_owned())]);
    assert_eq!(options.packages, [("arm".to_owned(), PathBuf::from("x/y"))]);
}

/// Changed bytes, removed, doubled or moved pieces: the result is expanded or refused.
#[test]
fn mutilated_files_are_expanded_or_refused() {
    use rand::{RngExt, SeedableRng};
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(7);
    let folder = Folder::new();
    let path = folder.at("robot.xacro");
    for turn in 0..1500 {
        let case = &CASES[turn % CASES.len()];
        let mut bytes = case.files[0].1.as_bytes().to_vec();
        for _ in 0..rng.random_range(1..4) {
            let (from, to) = (rng.random_range(0..bytes.len()), rng.random_range(0..bytes.len()));
            let piece: Vec<u8> = bytes[from..(from + rng.random_range(1..60)).min(bytes.len())].to_vec();
            match rng.random_range(0..3) {
                0 => bytes[from] = rng.random_range(32..127),
                1 => drop(bytes.drain(from..from + piece.len())),
                _ => drop(bytes.splice(to..to, piece)),
            }
        }
        folder.write("robot.xacro", &bytes);
        if let Ok(expanded) = expand_xacro(&path, &XacroOptions::default()) {
            assert!(expanded.text.starts_with("<?xml"));
        }
    }
}

/// Idioms of published descriptions beyond the reference cases.
#[test]
fn idioms_of_published_descriptions_are_expanded() {
    let folder = Folder::new();
    folder.write("arm_description/package.xml", "<package format=\"3\">\n  <name> arm_description </name></package>");
    folder.write(
        "arm_description/config/limits.yaml",
        "joint_limits:\n  pan:\n    max: !degrees  180.0\n    com: 0 0 0.1\n",
    );
    let macros = "<xacro:macro name=\"read\" params=\"file\">
        <xacro:property name=\"__limits\" value=\"${file['joint_limits']}\"/>
        <xacro:property name=\"pan_max\" value=\"${__limits['pan']['max']}\" scope=\"parent\"/>
        <xacro:property name=\"com\" value=\"${__limits.pan.com}\" scope=\"parent\"/>
      </xacro:macro>
      <xacro:macro name=\"link_at\" params=\"name prefix=${arm_id}_ xyz:='0 0 1'\">
        <xacro:property name=\"z\" value=\"${xyz.split(' ')[2]}\"/>
        <l name=\"${prefix}${name}\" z=\"${z + 1./2}\"/>
      </xacro:macro>";
    folder.write("arm_description/urdf/inc/macros.xacro", format!("{HEAD}{macros}</robot>"));
    let body = "<xacro:arg name=\"type\" default=\"limits\"/>
      <xacro:property name=\"arm_id\" value=\"panda\"/>
      <xacro:include filename=\"$(find arm_description)/urdf/inc/macros.xacro\"/>
      <xacro:if value=\"${'$(arg type)' == 'limits'}\">
        <xacro:macro name=\"arm\" params=\"config\"><xacro:read file=\"${config}\"/><l max=\"${pan_max}\" com=\"${com}\"/></xacro:macro>
      </xacro:if>
      <xacro:arm config=\"${xacro.load_yaml('$(find arm_description)/config/$(arg type).yaml')}\"/>
      <xacro:link_at name=\"tip\"/>";
    folder.write("arm_description/urdf/arm.xacro", format!("{HEAD}{body}</robot>"));
    let expanded = expand_xacro(&folder.at("arm_description/urdf/arm.xacro"), &XacroOptions::default()).unwrap();
    let expected =
        "<robot name=\"r\"><l max=\"3.141592653589793\" com=\"0 0 0.1\"/><l name=\"panda_tip\" z=\"1.5\"/></robot>";
    assert_eq!(canonical(&expanded.text), canonical(expected));
    let names: Vec<String> = expanded.files.iter().map(|file| file.name.clone()).collect();
    assert_eq!(names, ["arm.xacro", "macros.xacro", "limits.yaml"]);
}
