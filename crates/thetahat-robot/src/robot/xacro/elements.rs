//! The elements of xacro other than properties and calls.

use std::rc::Rc;

use super::{
    XacroError, XacroProblem,
    expansion::{Content, Done, at},
    folders::relative_to,
    macros::{Macro, parameters},
    scope::Block,
    state::Expander,
    substitution::literal,
    tree::{Element, Node},
    value::Value,
};
use thetahat_ground::files;

/// Most attributes that children give to their parent, and parameters of a macro.
const MOST_GIVEN: usize = 1000;

impl Expander {
    pub(super) fn define_macro(&mut self, element: &Element, scope: usize) -> Done {
        let remedy = "name the macro";
        let missing = || at(element, XacroProblem::Missing { attribute: "name", remedy });
        let name = element.attribute("name").ok_or_else(missing)?;
        if name.contains('.') || name == "call" {
            let expected = "a name without a dot, which separates namespaces, other than `call`";
            return Err(at(element, XacroProblem::Value { attribute: "name", expected, found: name.to_owned() }));
        }
        let name = name.strip_prefix("xacro:").unwrap_or(name).to_owned();
        let parameters = parameters(element.attribute("params").unwrap_or_default());
        if parameters.len() > MOST_GIVEN {
            return Err(at(element, XacroProblem::TooLarge { what: "parameters of a macro", limit: MOST_GIVEN }));
        }
        self.scopes.add_macro(scope, Macro { name, parameters, body: element.children.clone() });
        Ok(())
    }

    pub(super) fn define_argument(&mut self, element: &Element, scope: usize) -> Done {
        let name = self.attribute_text(element, "name", "name the argument", scope)?;
        if let Some(default) = element.attribute("default").filter(|_| !self.arguments.contains_key(&name)) {
            let default = self.value(element, default, scope)?.to_text();
            self.arguments.insert(name, default);
        }
        Ok(())
    }

    pub(super) fn conditional(
        &mut self,
        element: &Element,
        expected: bool,
        scope: usize,
        content: &mut Content,
    ) -> Done {
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
    pub(super) fn element(&mut self, element: &Element, scope: usize, content: &mut Content) -> Done {
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
    pub(super) fn attribute_of_parent(&mut self, element: &Element, scope: usize, content: &mut Content) -> Done {
        let name = self.attribute_text(element, "name", "name the attribute", scope)?;
        let value = self.attribute_text(element, "value", "give the value of the attribute", scope)?;
        if name.is_empty() || name.contains(|c: char| c.is_whitespace() || "<>&\"'/=".contains(c)) {
            let expected = "the name of an attribute";
            return Err(at(element, XacroProblem::Value { attribute: "name", expected, found: name }));
        }
        if content.attributes.len() >= MOST_GIVEN {
            return Err(at(
                element,
                XacroProblem::TooLarge { what: "attributes that children give", limit: MOST_GIVEN },
            ));
        }
        content.attributes.push((name, value));
        Ok(())
    }

    pub(super) fn insert_block(&mut self, element: &Element, scope: usize, content: &mut Content) -> Done {
        let name = self.attribute_text(element, "name", "name the block", scope)?;
        let unknown = || at(element, XacroProblem::UnknownBlock { name: name.clone() });
        let Block { element: block, whole } = self.scopes.block(scope, &name).cloned().ok_or_else(unknown)?;
        if whole {
            return self.expand_all(element, &[Node::Element(block)], scope, content);
        }
        self.expand_all(element, &block.children, scope, content)
    }

    pub(super) fn include(&mut self, element: &Element, scope: usize, content: &mut Content) -> Done {
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
        if self.truth(element, "optional", &optional)? && !files::exists(&path) {
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
