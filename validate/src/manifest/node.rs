// SPDX-License-Identifier: MIT OR Apache-2.0
//! JSON with members in the order they are written, and what is short on one line: a binding or a
//! struct member is one line of a diff.

/// A line breaks where it would grow longer.
const WIDTH: usize = 140;

/// A JSON value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Node {
    /// A number or truth value as it is printed.
    Plain(String),
    /// Text.
    Text(String),
    /// `[…]`
    List(Vec<Node>),
    /// `{…}`
    Object(Vec<(String, Node)>),
}

impl Node {
    /// An object.
    pub(super) fn object<const N: usize>(members: [(&str, Node); N]) -> Self {
        Self::Object(members.map(|(name, node)| (name.to_owned(), node)).into())
    }

    /// A list of what `items` are made into.
    pub(super) fn list<T>(items: impl IntoIterator<Item = T>, make: impl Fn(T) -> Node) -> Self {
        Self::List(items.into_iter().map(make).collect())
    }

    /// An object with more members at its end.
    pub(super) fn with<const N: usize>(mut self, more: [(&str, Node); N]) -> Self {
        if let Self::Object(members) = &mut self {
            members.extend(more.map(|(name, node)| (name.to_owned(), node)));
        }
        self
    }

    /// The document, with a line break at its end.
    pub(super) fn document(&self) -> String {
        let mut text = String::new();
        self.write(0, 0, &mut text);
        text.push('\n');
        text
    }

    fn compact(&self) -> String {
        match self {
            Self::Plain(text) => text.clone(),
            Self::Text(text) => quote(text),
            Self::List(items) => {
                let items: Vec<String> = items.iter().map(Self::compact).collect();
                format!("[{}]", items.join(", "))
            }
            Self::Object(members) if members.is_empty() => "{}".to_owned(),
            Self::Object(members) => {
                let member = |(name, node): &(String, Node)| format!("{}: {}", quote(name), node.compact());
                let members: Vec<String> = members.iter().map(member).collect();
                format!("{{ {} }}", members.join(", "))
            }
        }
    }

    /// `used` is what stands before the value on its line.
    fn write(&self, indent: usize, used: usize, text: &mut String) {
        let compact = self.compact();
        // A list of objects is a table: a row to a line.
        let is_table =
            matches!(self, Self::List(items) if items.iter().any(|item| matches!(item, Self::Object(_))));
        let is_leaf = matches!(self, Self::Plain(_) | Self::Text(_));
        if is_leaf || compact.len() <= 2 || (!is_table && indent + used + compact.len() < WIDTH) {
            text.push_str(&compact);
            return;
        }
        let inner = indent + 2;
        let pad = |text: &mut String, width: usize| {
            text.push('\n');
            text.extend(std::iter::repeat_n(' ', width));
        };
        let (open, close) = if matches!(self, Self::List(_)) { ('[', ']') } else { ('{', '}') };
        text.push(open);
        match self {
            Self::List(items) => {
                for (index, item) in items.iter().enumerate() {
                    text.push_str(if index == 0 { "" } else { "," });
                    pad(text, inner);
                    item.write(inner, 0, text);
                }
            }
            Self::Object(members) => {
                for (index, (name, node)) in members.iter().enumerate() {
                    text.push_str(if index == 0 { "" } else { "," });
                    pad(text, inner);
                    let name = format!("{}: ", quote(name));
                    text.push_str(&name);
                    node.write(inner, name.len(), text);
                }
            }
            Self::Plain(_) | Self::Text(_) => {}
        }
        pad(text, indent);
        text.push(close);
    }
}

fn quote(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

impl From<&str> for Node {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Node {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

macro_rules! plain {
    ($($type:ty),*) => {$(
        impl From<$type> for Node {
            fn from(value: $type) -> Self {
                Self::Plain(value.to_string())
            }
        }
    )*};
}

plain!(u32, u64, i32, bool);

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn it_is_json_with_rows_on_lines() {
        let row = |name: &str| Node::object([("name", name.into()), ("size", 4_u32.into())]);
        let long: Vec<Node> = (0..80_u32).map(Node::from).collect();
        let node = Node::object([
            ("text", "a \"b\"\n".into()),
            ("rows", Node::List(vec![row("x"), row("y")])),
            ("long", Node::List(long)),
            ("none", Node::List(Vec::new())),
        ]);
        let text = node.document();
        assert!(text.contains("\n    { \"name\": \"x\", \"size\": 4 },\n"), "{text}");
        let value: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!(value["text"], "a \"b\"\n");
        assert_eq!(value["rows"][1]["name"], "y");
        assert_eq!(value["long"][79], 79);
        assert_eq!(value["none"], serde_json::json!([]));
    }
}
