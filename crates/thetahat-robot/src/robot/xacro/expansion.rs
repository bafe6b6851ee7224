//! Elements of xacro, replaced by what they stand for.

use std::{
    path::{Path, PathBuf},
    rc::Rc,
};

use super::{
    XacroError, XacroOptions, XacroProblem,
    evaluation::Evaluated,
    scope::GLOBAL,
    state::{Expander, text_problem},
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

pub(super) type Done = Result<(), XacroError>;

/// The error of an element.
pub(super) fn at(element: &Element, problem: XacroProblem) -> XacroError {
    XacroError::Element { place: element.place(), problem: Box::new(problem) }
}

impl Expander {
    /// The root of a file.
    pub(super) fn tree(&mut self, path: &Path) -> Result<Element, XacroError> {
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

    /// The value of a text as it is written to the expansion.
    fn written(&mut self, element: &Element, text: &str, scope: usize) -> Result<String, XacroError> {
        let value = self.value(element, text, scope)?;
        self.add_bytes(value.size()).map_err(|problem| at(element, problem))?;
        Ok(value.to_text())
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
                attributes.push((name.clone(), self.written(element, text, scope)?));
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
                    let text = self.written(parent, text, scope)?;
                    self.add_node().map_err(|problem| at(parent, problem))?;
                    content.nodes.push(Node::Text(Rc::from(text)));
                }
            }
        }
        self.leave();
        Ok(())
    }

    pub(super) fn expand(&mut self, element: &Rc<Element>, scope: usize, content: &mut Content) -> Done {
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
}
