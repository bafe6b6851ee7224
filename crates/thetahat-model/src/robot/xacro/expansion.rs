//! Elements of xacro, replaced by what they stand for.

use std::{
    path::{Path, PathBuf},
    rc::Rc,
};

use super::{
    XacroError, XacroOptions, XacroProblem,
    evaluation::Evaluated,
    folders::relative_to,
    macros::{Macro, parameters},
    scope::{Block, GLOBAL},
    state::{Expander, text_problem},
    substitution::literal,
    tree::{Element, Node, namespaces_of, to_text, tree_of},
    value::Value,
};
use crate::robot::{text_file::RobotFile, urdf::parse_xml};

/// The URDF that a xacro stands for.
#[derive(Debug)]
pub struct ExpandedXacro {
    /// Its text.
    pub text: String,
    /// The paths of the files that were read, that of the xacro first.
    pub paths: Vec<PathBuf>,
    /// The same files with digests of their content.
    pub files: Vec<RobotFile>,
}

/// Expands the xacro at `path` to URDF.
///
/// # Errors
/// [`XacroError`] with file, line and remedy.
pub fn expand_xacro(path: &Path, options: &XacroOptions) -> Result<ExpandedXacro, XacroError> {
    let mut expander = Expander::new(path, options);
    let root = expander.tree(path)?;
    expander.current.push(path.to_owned());
    let root = expander.plain(&root, GLOBAL)?;
    let (paths, files) = expander.files.into_iter().unzip();
    Ok(ExpandedXacro { text: to_text(&root, &expander.namespaces), paths, files })
}

/// What the children of an element become.
#[derive(Default)]
pub(super) struct Content {
    pub(super) nodes: Vec<Node>,
    /// Attributes that children give to their parent.
    pub(super) attributes: Vec<(String, String)>,
}

type Done = Result<(), XacroError>;

/// The error of an element.
pub(super) fn at(element: &Element, problem: XacroProblem) -> XacroError {
    XacroError::Element { place: element.place(), problem: Box::new(problem) }
}

impl Expander {
    /// The root of a file.
    fn tree(&mut self, path: &Path) -> Result<Element, XacroError> {
        let text = self.read(path)?;
        let document = parse_xml(&text, path)?;
        for (prefix, uri) in namespaces_of(&document) {
            if self.namespaces.iter().all(|(known, _)| *known != prefix) {
                self.namespaces.push((prefix, uri));
            }
        }
        tree_of(&document, &Rc::from(path)).map_err(|problem| {
            let problem = Box::new(problem);
            XacroError::Reading { path: path.to_owned(), problem }
        })
    }

    /// The value of a text of an element.
    pub(super) fn value(&mut self, element: &Element, text: &str, scope: usize) -> Result<Value, XacroError> {
        let value: Evaluated = self.text_value(text, scope);
        value.map_err(|error| at(element, text_problem(text, error)))
    }

    pub(super) fn attribute_text(
        &mut self,
        element: &Element,
        name: &'static str,
        remedy: &'static str,
        scope: usize,
    ) -> Result<String, XacroError> {
        let text =
            element.attribute(name).ok_or_else(|| at(element, XacroProblem::Missing { attribute: name, remedy }))?;
        Ok(self.value(element, text, scope)?.to_text())
    }

    /// An element of URDF with its texts evaluated and its children expanded.
    pub(super) fn plain(&mut self, element: &Element, scope: usize) -> Result<Element, XacroError> {
        let mut attributes = Vec::new();
        for (name, text) in &element.attributes {
            if !name.starts_with("xacro:") {
                attributes.push((name.clone(), self.value(element, text, scope)?.to_text()));
            }
        }
        let content = self.content(element, &element.children, scope)?;
        for (name, value) in content.attributes {
            match attributes.iter_mut().find(|(known, _)| *known == name) {
                Some((_, before)) => *before = value,
                None => attributes.push((name, value)),
            }
        }
        let (name, path) = (element.name.clone(), Rc::clone(&element.path));
        Ok(Element { name, attributes, children: content.nodes, path, line: element.line })
    }

    pub(super) fn content(&mut self, parent: &Element, nodes: &[Node], scope: usize) -> Result<Content, XacroError> {
        let mut content = Content::default();
        self.expand_all(parent, nodes, scope, &mut content)?;
        Ok(content)
    }

    pub(super) fn expand_all(&mut self, parent: &Element, nodes: &[Node], scope: usize, content: &mut Content) -> Done {
        self.enter().map_err(|problem| at(parent, problem))?;
        for node in nodes {
            match node {
                Node::Element(element) => self.expand(element, scope, content)?,
                Node::Text(text) => {
                    let text = self.value(parent, text, scope)?.to_text();
                    self.add_node().map_err(|problem| at(parent, problem))?;
                    content.nodes.push(Node::Text(Rc::from(text)));
                }
            }
        }
        self.leave();
        Ok(())
    }

    fn expand(&mut self, element: &Rc<Element>, scope: usize, content: &mut Content) -> Done {
        self.add_node().map_err(|problem| at(element, problem))?;
        let Some(tag) = element.name.strip_prefix("xacro:") else {
            let expanded = self.plain(element, scope)?;
            content.nodes.push(Node::Element(Rc::new(expanded)));
            return Ok(());
        };
        match tag {
            "property" => self.define_property(element, scope),
            "macro" => self.define_macro(element, scope),
            "arg" => self.define_argument(element, scope),
            "include" => self.include(element, scope, content),
            "insert_block" => self.insert_block(element, scope, content),
            "if" => self.conditional(element, true, scope, content),
            "unless" => self.conditional(element, false, scope, content),
            "element" => self.element(element, scope, content),
            "attribute" => self.attribute_of_parent(element, scope, content),
            "call" => {
                let name = self.attribute_text(element, "macro", "name the macro that is called", scope)?;
                self.call_macro(element, &name, scope, content)
            }
            name => self.call_macro(element, name, scope, content),
        }
    }

    fn define_macro(&mut self, element: &Element, scope: usize) -> Done {
        let remedy = "name the macro";
        let missing = || at(element, XacroProblem::Missing { attribute: "name", remedy });
        let name = element.attribute("name").ok_or_else(missing)?;
        if name.contains('.') || name == "call" {
            let expected = "a name without a dot, which separates namespaces, other than `call`";
            return Err(at(element, XacroProblem::Value { attribute: "name", expected, found: name.to_owned() }));
        }
        let name = name.strip_prefix("xacro:").unwrap_or(name).to_owned();
        let parameters = parameters(element.attribute("params").unwrap_or_default());
        self.scopes.add_macro(scope, Macro { name, parameters, body: element.children.clone() });
        Ok(())
    }

    fn define_argument(&mut self, element: &Element, scope: usize) -> Done {
        let name = self.attribute_text(element, "name", "name the argument", scope)?;
        if let Some(default) = element.attribute("default").filter(|_| !self.arguments.contains_key(&name)) {
            let default = self.value(element, default, scope)?.to_text();
            self.arguments.insert(name, default);
        }
        Ok(())
    }

    fn conditional(&mut self, element: &Element, expected: bool, scope: usize, content: &mut Content) -> Done {
        let remedy = "give the condition, such as value=\"${wheels > 2}\"";
        let missing = || at(element, XacroProblem::Missing { attribute: "value", remedy });
        let text = element.attribute("value").ok_or_else(missing)?;
        let value = self.value(element, text, scope)?;
        if self.truth(element, "value", &value)? == expected {
            return self.expand_all(element, &element.children, scope, content);
        }
        Ok(())
    }

    /// Whether the value of an attribute is true.
    pub(super) fn truth(&self, element: &Element, attribute: &'static str, value: &Value) -> Result<bool, XacroError> {
        let Value::Text(text) = value else { return Ok(value.is_true()) };
        match (&**text, text.trim().parse::<i64>()) {
            ("true" | "True", _) => Ok(true),
            ("false" | "False", _) => Ok(false),
            (_, Ok(number)) => Ok(number != 0),
            (found, Err(_)) => {
                let (expected, found) = ("true, false, 1 or 0", found.to_owned());
                Err(at(element, XacroProblem::Value { attribute, expected, found }))
            }
        }
    }

    /// `<xacro:element>`: an element whose name is a text to evaluate.
    fn element(&mut self, element: &Element, scope: usize, content: &mut Content) -> Done {
        let name = self.attribute_text(element, "xacro:name", "give the name of the element as xacro:name", scope)?;
        if name.is_empty() || name.contains(|c: char| c.is_whitespace() || "<>&\"'/=".contains(c)) {
            let expected = "the name of an element";
            return Err(at(element, XacroProblem::Value { attribute: "xacro:name", expected, found: name }));
        }
        let attributes = element.attributes.iter().filter(|(name, _)| name != "xacro:name").cloned().collect();
        let named = Rc::new(Element { name, attributes, ..element.clone() });
        self.enter().map_err(|problem| at(element, problem))?;
        self.expand(&named, scope, content)?;
        self.leave();
        Ok(())
    }

    /// `<xacro:attribute>`: an attribute of the element around it.
    fn attribute_of_parent(&mut self, element: &Element, scope: usize, content: &mut Content) -> Done {
        let name = self.attribute_text(element, "name", "name the attribute", scope)?;
        let value = self.attribute_text(element, "value", "give the value of the attribute", scope)?;
        if name.is_empty() || name.contains(|c: char| c.is_whitespace() || "<>&\"'/=".contains(c)) {
            let expected = "the name of an attribute";
            return Err(at(element, XacroProblem::Value { attribute: "name", expected, found: name }));
        }
        content.attributes.push((name, value));
        Ok(())
    }

    fn insert_block(&mut self, element: &Element, scope: usize, content: &mut Content) -> Done {
        let name = self.attribute_text(element, "name", "name the block", scope)?;
        let unknown = || at(element, XacroProblem::UnknownBlock { name: name.clone() });
        let Block { element: block, whole } = self.scopes.block(scope, &name).cloned().ok_or_else(unknown)?;
        if whole {
            return self.expand_all(element, &[Node::Element(block)], scope, content);
        }
        self.expand_all(element, &block.children, scope, content)
    }

    fn include(&mut self, element: &Element, scope: usize, content: &mut Content) -> Done {
        let spec = self.attribute_text(element, "filename", "name the file, relative to this one", scope)?;
        if spec.contains(['*', '?', '[']) {
            return Err(at(element, XacroProblem::Pattern { pattern: spec }));
        }
        let inner = match element.attribute("ns") {
            None => scope,
            Some(text) => {
                let name = self.value(element, text, scope)?.to_text();
                self.scopes.add_namespace(scope, &name)
            }
        };
        let path = relative_to(self.file(), &spec);
        let optional = literal(Value::text(element.attribute("optional").unwrap_or("false")));
        if self.truth(element, "optional", &optional)? && !thetahat_ground::files::exists(&path) {
            return Ok(());
        }
        // Before the file is read: the depth bounds the number of files that include one another.
        self.enter().map_err(|problem| at(element, problem))?;
        let root = self.tree(&path).map_err(|error| of_include(element, error))?;
        self.current.push(path);
        self.expand_all(&root, &root.children, inner, content)?;
        self.current.pop();
        self.leave();
        Ok(())
    }
}

/// The error of a file that cannot be read names the element that includes it; one inside the file has its place already.
fn of_include(element: &Element, error: XacroError) -> XacroError {
    match error {
        XacroError::File { .. } => at(element, XacroProblem::File { error: Box::new(error) }),
        XacroError::Reading { problem, .. } => at(element, *problem),
        XacroError::Xml(_) | XacroError::Element { .. } | XacroError::Option { .. } => error,
    }
}
