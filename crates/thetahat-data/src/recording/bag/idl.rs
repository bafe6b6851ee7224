//! Types from the interface definition language (IDL) of the OMG, what ROS 2 uses of it: modules, structures, type names, enumerations,
//! sequences and arrays. Constants, annotations and comments are skipped.

use std::collections::HashMap;

use super::idl_tokens::{Token, tokens};
use super::schema::{Count, Declared, DeclaredField, DeclaredKind, Kind, Number, normal};

/// The structures of a text.
pub(super) fn types(text: &str) -> Result<Vec<Declared>, String> {
    let tokens = tokens(text)?;
    let mut parser = Parser { tokens: &tokens, at: 0, modules: Vec::new(), names: HashMap::new(), types: Vec::new() };
    parser.definitions()?;
    Ok(parser.types)
}

/// What a type holds, and how many.
type Content = (DeclaredKind, Count);

struct Parser<'a> {
    tokens: &'a [Token<'a>],
    at: usize,
    modules: Vec<&'a str>,
    /// Types that are other names of types, by package and name.
    names: HashMap<String, Content>,
    types: Vec<Declared>,
}

impl<'a> Parser<'a> {
    fn definitions(&mut self) -> Result<(), String> {
        while let Some(token) = self.next() {
            match token {
                Token::Word("module") => {
                    let name = self.word()?;
                    self.modules.push(name);
                    self.require('{')?;
                }
                Token::Sign('}') => self.modules.pop().map(|_| ()).ok_or("there is a } without its {")?,
                Token::Sign(';') => {}
                Token::Sign('@') => self.skip_annotation()?,
                Token::Word("const") => self.skip_to(';')?,
                Token::Word("struct") => self.structure()?,
                Token::Word("typedef") => self.type_name()?,
                Token::Word("enum") => self.enumeration()?,
                Token::Word(_) | Token::Sign(_) | Token::Quoted => return Err(unexpected(Some(token))),
            }
        }
        Ok(())
    }

    fn structure(&mut self) -> Result<(), String> {
        let name = self.word()?;
        self.require('{')?;
        let mut fields = Vec::new();
        loop {
            match self.peek() {
                Some(Token::Sign('}')) => break,
                Some(Token::Sign('@')) => {
                    self.at += 1;
                    self.skip_annotation()?;
                }
                Some(Token::Word(_) | Token::Sign(_) | Token::Quoted) => self.members(&mut fields)?,
                None => return Err(unexpected(None)),
            }
        }
        self.require('}')?;
        let name = self.full_name(name);
        self.types.push(Declared { name, fields });
        Ok(())
    }

    /// The members of one line: a type and one name or several.
    fn members(&mut self, fields: &mut Vec<DeclaredField>) -> Result<(), String> {
        let content = self.content()?;
        loop {
            let name = self.word()?.to_owned();
            let (kind, count) = self.dimensions(content.clone())?;
            fields.push(DeclaredField { name, kind, count });
            match self.next() {
                Some(Token::Sign(',')) => {}
                Some(Token::Sign(';')) => return Ok(()),
                other => return Err(unexpected(other)),
            }
        }
    }

    fn type_name(&mut self) -> Result<(), String> {
        let content = self.content()?;
        let name = self.word()?;
        let content = self.dimensions(content)?;
        self.names.insert(self.full_name(name), content);
        self.require(';')
    }

    fn enumeration(&mut self) -> Result<(), String> {
        let name = self.word()?;
        self.skip_to('}')?;
        self.names.insert(self.full_name(name), (DeclaredKind::Known(Kind::Number(Number::U32)), Count::One));
        Ok(())
    }

    /// A type: a number, text, a sequence, or the name of a type.
    fn content(&mut self) -> Result<Content, String> {
        match self.word()? {
            "sequence" => self.sequence(),
            "string" => self.text(Kind::Text),
            "wstring" => self.text(Kind::WideText),
            "unsigned" => self.unsigned().map(number),
            "long" => Ok(number(if self.accept_word("long") { Number::I64 } else { Number::I32 })),
            word => match number_of(word) {
                Some(known) => Ok(number(known)),
                None => self.named(word),
            },
        }
    }

    fn sequence(&mut self) -> Result<Content, String> {
        self.require('<')?;
        if self.peek() == Some(Token::Word("sequence")) {
            return Err("a sequence of sequences is not read".to_owned());
        }
        let (kind, count) = self.content()?;
        self.skip_to('>')?;
        if count == Count::One { Ok((kind, Count::Sequence)) } else { Err(nested()) }
    }

    fn text(&mut self, kind: Kind) -> Result<Content, String> {
        if self.peek() == Some(Token::Sign('<')) {
            self.skip_to('>')?;
        }
        Ok((DeclaredKind::Known(kind), Count::One))
    }

    fn unsigned(&mut self) -> Result<Number, String> {
        match self.word()? {
            "short" => Ok(Number::U16),
            "long" if self.accept_word("long") => Ok(Number::U64),
            "long" => Ok(Number::U32),
            other => Err(format!("expected short or long after unsigned, found {other:?}")),
        }
    }

    /// A type by its name, as `builtin_interfaces::msg::Time`.
    fn named(&mut self, first: &str) -> Result<Content, String> {
        let mut name = first.to_owned();
        while self.peek() == Some(Token::Sign(':')) {
            self.at += 1;
            self.require(':')?;
            name = format!("{name}/{}", self.word()?);
        }
        let name = if name.contains('/') { normal(&name) } else { self.full_name(&name) };
        Ok(self.names.get(&name).cloned().unwrap_or((DeclaredKind::Named(name), Count::One)))
    }

    /// The sides of an array after a name.
    fn dimensions(&mut self, content: Content) -> Result<Content, String> {
        let mut sides = None;
        while self.peek() == Some(Token::Sign('[')) {
            self.at += 1;
            let side: usize = self.word()?.parse().map_err(|_| "expected the length of an array".to_owned())?;
            self.require(']')?;
            sides = Some(sides.unwrap_or(1_usize).checked_mul(side).ok_or_else(nested)?);
        }
        match (sides, content) {
            (None, content) => Ok(content),
            (Some(side), (kind, Count::One)) => Ok((kind, Count::Fixed(side))),
            (Some(_), (_, Count::Fixed(_) | Count::Sequence)) => Err(nested()),
        }
    }

    fn full_name(&self, name: &str) -> String {
        let package = self.modules.first().copied().unwrap_or_default();
        normal(&format!("{package}/{name}"))
    }

    fn skip_annotation(&mut self) -> Result<(), String> {
        self.word()?;
        if self.peek() != Some(Token::Sign('(')) {
            return Ok(());
        }
        let mut open = 0_usize;
        while let Some(token) = self.next() {
            match token {
                Token::Sign('(') => open += 1,
                Token::Sign(')') if open == 1 => return Ok(()),
                Token::Sign(')') => open -= 1,
                Token::Word(_) | Token::Sign(_) | Token::Quoted => {}
            }
        }
        Err(unexpected(None))
    }

    fn skip_to(&mut self, sign: char) -> Result<(), String> {
        while let Some(token) = self.next() {
            if token == Token::Sign(sign) {
                return Ok(());
            }
        }
        Err(unexpected(None))
    }

    fn peek(&self) -> Option<Token<'a>> {
        self.tokens.get(self.at).copied()
    }

    fn next(&mut self) -> Option<Token<'a>> {
        let token = self.peek();
        self.at += 1;
        token
    }

    fn word(&mut self) -> Result<&'a str, String> {
        match self.next() {
            Some(Token::Word(word)) => Ok(word),
            other => Err(unexpected(other)),
        }
    }

    fn accept_word(&mut self, word: &str) -> bool {
        let is_next = self.peek() == Some(Token::Word(word));
        self.at += usize::from(is_next);
        is_next
    }

    fn require(&mut self, sign: char) -> Result<(), String> {
        match self.next() {
            Some(Token::Sign(found)) if found == sign => Ok(()),
            other => Err(unexpected(other)),
        }
    }
}

fn number(number: Number) -> Content {
    (DeclaredKind::Known(Kind::Number(number)), Count::One)
}

fn number_of(word: &str) -> Option<Number> {
    match word {
        "boolean" | "octet" | "char" | "uint8" => Some(Number::U8),
        "int8" => Some(Number::I8),
        "short" | "int16" => Some(Number::I16),
        "uint16" => Some(Number::U16),
        "int32" => Some(Number::I32),
        "uint32" => Some(Number::U32),
        "int64" => Some(Number::I64),
        "uint64" => Some(Number::U64),
        "float" => Some(Number::F32),
        "double" => Some(Number::F64),
        _ => None,
    }
}

fn nested() -> String {
    "an array of arrays is not read".to_owned()
}

fn unexpected(token: Option<Token<'_>>) -> String {
    let found = match token {
        Some(Token::Word(word)) => format!("{word:?}"),
        Some(Token::Sign(sign)) => format!("{sign:?}"),
        Some(Token::Quoted) => "a text in quotes".to_owned(),
        None => "its end".to_owned(),
    };
    format!("the IDL is not as expected at {found}")
}
