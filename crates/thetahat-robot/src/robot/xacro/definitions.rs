//! Properties, and calls of macros.

use std::rc::Rc;

use super::{
    XacroError, XacroProblem,
    expansion::{Content, Done, at},
    macros::{Macro, Parameter},
    scope::{Block, GLOBAL, Property},
    state::Expander,
    substitution::literal,
    tree::{Element, Node, elements_of},
    value::Value,
};

impl Expander {
    /// `<xacro:property>`: a value, a default, a block, or the removal of one.
    pub(super) fn define_property(&mut self, element: &Rc<Element>, scope: usize) -> Done {
        let name = self.property_name(element, scope)?;
        if self.flag(element, "remove", false, scope)? {
            self.scopes.remove(scope, &name);
            return Ok(());
        }
        let (value, default) = (element.attribute("value"), element.attribute("default"));
        if value.is_some() && default.is_some() {
            let expected = "left out where there is a value";
            let found = default.unwrap_or_default().to_owned();
            return Err(at(element, XacroProblem::Value { attribute: "default", expected, found }));
        }
        if default.is_some() && self.is_defined(scope, &name) {
            return Ok(());
        }
        let (target, is_elsewhere) = self.target(element, scope)?;
        let Some(text) = value.or(default) else {
            let block = Block { element: Rc::clone(element), whole: false };
            self.scopes.set_block(target, &name, block);
            return Ok(());
        };
        let is_lazy = self.flag(element, "lazy_eval", true, scope)? && !is_elsewhere;
        let property = match is_lazy {
            true => unevaluated(text),
            false => Property::Known(literal(self.value(element, text, scope)?)),
        };
        self.scopes.set(target, &name, property);
        Ok(())
    }

    fn property_name(&mut self, element: &Element, scope: usize) -> Result<String, XacroError> {
        let found = self.attribute_text(element, "name", "name the property", scope)?;
        let letters = |c: char| c.is_alphanumeric() || c == '_';
        let is_name = found.chars().all(letters) && !found.starts_with(|c: char| c.is_ascii_digit());
        if is_name && !found.is_empty() {
            return Ok(found);
        }
        let expected = "letters, digits and _, beginning with a letter";
        Err(at(element, XacroProblem::Value { attribute: "name", expected, found }))
    }

    fn flag(
        &mut self,
        element: &Element,
        attribute: &'static str,
        default: bool,
        scope: usize,
    ) -> Result<bool, XacroError> {
        let Some(text) = element.attribute(attribute) else { return Ok(default) };
        let value = self.value(element, text, scope)?;
        self.truth(element, attribute, &value)
    }

    fn is_defined(&self, scope: usize, name: &str) -> bool {
        self.scopes.owner(scope, name).is_some()
    }

    /// The scope of a property, and whether it is another one than here.
    fn target(&self, element: &Element, scope: usize) -> Result<(usize, bool), XacroError> {
        match element.attribute("scope") {
            None | Some("local") => Ok((scope, false)),
            Some("global") => Ok((GLOBAL, true)),
            Some("parent") => Ok((self.scopes.caller(scope).unwrap_or(GLOBAL), true)),
            Some(found) => {
                let (expected, found) = ("global, parent, or left out", found.to_owned());
                Err(at(element, XacroProblem::Value { attribute: "scope", expected, found }))
            }
        }
    }

    /// Replaces the call of a macro by its body.
    pub(super) fn call_macro(&mut self, call: &Element, name: &str, scope: usize, content: &mut Content) -> Done {
        let unknown = || at(call, XacroProblem::UnknownMacro { name: name.to_owned() });
        let (called, outside) = self.scopes.find_macro(scope, name).ok_or_else(unknown)?;
        let blocks = self.content(call, &call.children, scope)?;
        let inner = self.scopes.enter(outside);
        let expanded = self.bind(call, &called, scope, inner, &blocks.nodes).and_then(|()| {
            let mut body = Content::default();
            self.expand_all(call, &called.body, inner, &mut body)?;
            Ok(body)
        });
        self.scopes.leave(inner);
        let body = expanded?;
        content.nodes.extend(body.nodes);
        content.attributes.extend(body.attributes);
        Ok(())
    }

    /// Gives the parameters of a macro their values in the scope `inner`.
    fn bind(&mut self, call: &Element, called: &Macro, scope: usize, inner: usize, blocks: &[Node]) -> Done {
        self.check_names(call, called)?;
        for (name, text) in arguments(call) {
            let value = literal(self.value(call, text, scope)?);
            self.scopes.set(inner, name, Property::Known(value));
        }
        let mut elements = elements_of(blocks);
        let mut missing = Vec::new();
        for parameter in &called.parameters {
            let is_bound = match parameter.block() {
                Some(block) => self.bind_block(block, elements.next(), inner),
                None => self.bind_default(call, parameter, scope, inner)?,
            };
            missing.extend((!is_bound).then(|| parameter.name.clone()));
        }
        if !missing.is_empty() {
            return Err(at(call, XacroProblem::MissingParameters { name: called.name.clone(), missing }));
        }
        elements.next().map_or(Ok(()), |element| {
            let (name, block) = (called.name.clone(), element.name.clone());
            Err(at(call, XacroProblem::UnusedBlock { name, block }))
        })
    }

    /// Whether there is an element for a block.
    fn bind_block(&mut self, (name, whole): (&str, bool), element: Option<&Rc<Element>>, inner: usize) -> bool {
        let block = element.map(|element| Block { element: Rc::clone(element), whole });
        let is_bound = block.is_some();
        block.into_iter().for_each(|block| self.scopes.set_block(inner, name, block));
        is_bound
    }

    fn check_names(&self, call: &Element, called: &Macro) -> Done {
        let known = |name: &str| called.parameters.iter().any(|parameter| parameter.name == name);
        let Some((name, _)) = arguments(call).find(|(name, _)| !known(name)) else { return Ok(()) };
        Err(at(
            call,
            XacroProblem::UnknownParameter {
                name: called.name.clone(),
                parameter: name.to_owned(),
                known: called.parameters.iter().map(|parameter| parameter.name.clone()).collect(),
            },
        ))
    }

    /// Whether a parameter has a value: that of the call, or its default.
    fn bind_default(
        &mut self,
        call: &Element,
        parameter: &Parameter,
        scope: usize,
        inner: usize,
    ) -> Result<bool, XacroError> {
        if arguments(call).any(|(name, _)| name == parameter.name) {
            return Ok(true);
        }
        let Some(default) = &parameter.default else { return Ok(false) };
        let forwarded = match default.forwarded && self.is_defined(scope, &parameter.name) {
            true => Some(self.value(call, &format!("${{{}}}", parameter.name), scope)?),
            false => None,
        };
        let value = match (forwarded, &default.text) {
            (Some(value), _) => value,
            (None, Some(text)) => self.value(call, text, scope)?,
            (None, None) => return Ok(false),
        };
        self.scopes.set(inner, &parameter.name, Property::Known(literal(value)));
        Ok(true)
    }
}

/// A property whose text is evaluated when it is first used, unless it is a number or a truth value.
fn unevaluated(text: &str) -> Property {
    match literal(Value::text(text)) {
        // Without its quotes, as the reference evaluates it.
        Value::Text(text) => Property::Text(text),
        known @ (Value::None
        | Value::Bool(_)
        | Value::Integer(_)
        | Value::Float(_)
        | Value::List(_)
        | Value::Map(_)
        | Value::Function(_)
        | Value::Module
        | Value::Namespace(_)) => Property::Known(known),
    }
}

/// The values that a call gives by attributes.
fn arguments(call: &Element) -> impl Iterator<Item = (&str, &str)> {
    let is_of_call = call.name == "xacro:call";
    let given = call.attributes.iter().map(|(name, text)| (name.as_str(), text.as_str()));
    given.filter(move |(name, _)| !(name.starts_with("xmlns") || is_of_call && *name == "macro"))
}
