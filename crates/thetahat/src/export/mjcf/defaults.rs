//! Attributes that elements have from their class.

use std::collections::HashMap;

use super::element::Element;

/// The class of elements that name none.
pub(super) const MAIN: &str = "main";

/// The `<default>` elements of an MJCF, by their class.
#[derive(Debug, Default)]
pub(super) struct Defaults<'a> {
    classes: HashMap<&'a str, Vec<Element<'a>>>,
}

impl<'a> Defaults<'a> {
    pub(super) fn read(root: Element<'a>) -> Self {
        let mut classes: HashMap<_, Vec<Element<'a>>> = HashMap::new();
        for top in root.named("default") {
            for default in top.descendants().filter(|element| element.tag() == "default") {
                classes.entry(class_of(default)).or_default().push(default);
            }
        }
        Self { classes }
    }

    /// The attribute of an element: its own, or that of its class or of a class around that.
    pub(super) fn of(&self, element: Element<'a>, class: &'a str, key: &str) -> Option<&'a str> {
        element
            .attribute(key)
            .or_else(|| self.of_class(element.tag(), element.attribute("class").unwrap_or(class), key))
    }

    fn of_class(&self, tag: &str, class: &'a str, key: &str) -> Option<&'a str> {
        let mut class = class;
        // Each step goes outwards; a class that names itself ends it.
        for _ in 0..=self.classes.len() {
            let defaults = self.classes.get(class)?;
            let mut elements = defaults.iter().flat_map(|default| default.elements()).filter(|e| e.tag() == tag);
            if let Some(value) = elements.find_map(|element| element.attribute(key)) {
                return Some(value);
            }
            if class == MAIN {
                return None;
            }
            let outer = defaults.iter().find_map(|default| default.node.parent_element());
            class = outer
                .filter(|node| node.tag_name().name() == "default")
                .map_or(MAIN, |node| node.attribute("class").unwrap_or(MAIN));
        }
        None
    }
}

fn class_of(default: Element<'_>) -> &str {
    default.attribute("class").unwrap_or(MAIN)
}
