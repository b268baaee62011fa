//! A page of HTML that stands alone: no font, script, style or picture comes from elsewhere.

use std::fmt::Write as _;

use super::canvas::Picture;

const STYLE: &str = include_str!("page.css");

/// A page while it is written. Texts are HTML; what comes from a person passes [`escape`] first.
pub struct Page {
    title: String,
    body: String,
    figures: u32,
}

/// How the pictures of a figure stand beside each other where the page is wide enough.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layout {
    /// One picture.
    Single,
    /// Two beside each other.
    Pair,
    /// Three beside each other.
    Triple,
}

impl Page {
    /// A page with a title and a sentence that says what it is.
    pub fn new(title: &str, lead: &str) -> Self {
        let body = format!("<header><h1>{}</h1><p class=\"lead\">{lead}</p></header>\n", escape(title));
        Self { title: title.to_string(), body, figures: 0 }
    }

    /// A heading.
    pub fn heading(&mut self, text: &str) {
        let _ = writeln!(self.body, "<h2>{}</h2>", escape(text));
    }

    /// A paragraph.
    pub fn paragraph(&mut self, text: &str) {
        let _ = writeln!(self.body, "<p>{text}</p>");
    }

    /// Anything.
    pub fn block(&mut self, html: &str) {
        self.body += html;
        self.body.push('\n');
    }

    /// Short facts: name, value, unit.
    pub fn facts(&mut self, facts: &[(&str, String, &str)]) {
        self.body += "<dl class=\"facts\">";
        for (name, value, unit) in facts {
            let (name, value, unit) = (escape(name), escape(value), escape(unit));
            let _ = write!(self.body, "<div><dt>{name}</dt><dd>{value} <small>{unit}</small></dd></div>");
        }
        self.body += "</dl>\n";
    }

    /// A numbered figure with a caption that says what to see.
    pub fn figure(&mut self, pictures: &[Picture], layout: Layout, caption: &str) {
        self.figures += 1;
        let class = match layout {
            Layout::Single => "single",
            Layout::Pair => "pair",
            Layout::Triple => "triple",
        };
        let _ = write!(self.body, "<figure class=\"{class}\"><div>");
        for picture in pictures {
            self.body += &picture.inline();
        }
        let number = self.figures;
        let _ = writeln!(self.body, "</div><figcaption><b>Figure {number}.</b> {caption}</figcaption></figure>");
    }

    /// The page.
    pub fn finish(self) -> String {
        let Self { title, body, .. } = self;
        let (title, version) = (escape(&title), env!("CARGO_PKG_VERSION"));
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n{body}\
             <footer>Made by hodograph {version}.</footer>\n</main>\n</body>\n</html>\n"
        )
    }
}

/// `text` as HTML or XML shows it.
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            other => out.push(other),
        }
    }
    out
}

/// A table whose first `words` columns and, where there is a last one with reasons, that one hold words; the others hold numbers.
pub fn table(
    head: &[&str],
    words: usize,
    reasons: bool,
    rows: impl Iterator<Item = (&'static str, Vec<String>)>,
) -> String {
    let last = head.len() - 1;
    let cell = |tag: &str, (column, text): (usize, &str)| {
        let is_word = column < words || (reasons && column == last);
        let style = if is_word { " style=\"text-align: left; white-space: normal\"" } else { "" };
        format!("<{tag}{style}>{}</{tag}>", escape(text))
    };
    let head: String = head.iter().copied().enumerate().map(|named| cell("th", named)).collect();
    let row = |(style, row): (&str, Vec<String>)| {
        let cells: String = row.iter().map(String::as_str).enumerate().map(|text| cell("td", text)).collect();
        format!("<tr style=\"{style}\">{cells}</tr>")
    };
    let body: String = rows.map(row).collect();
    format!("<div class=\"scroll\"><table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>")
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Every element is closed by its own name, in order, and no `<` stands outside a tag.
    pub fn assert_balanced(text: &str) {
        let mut open: Vec<&str> = Vec::new();
        let mut rest = text;
        while let Some(at) = rest.find('<') {
            let end = at + rest[at..].find('>').expect("every tag ends");
            let tag = &rest[at + 1..end];
            rest = &rest[end + 1..];
            let name = tag.trim_start_matches('/').split([' ', '/']).next().unwrap_or("");
            assert_eq!(tag.matches('"').count() % 2, 0, "quotes in <{tag}>");
            assert!(!tag.contains('<'), "<{tag}>");
            if let Some(closed) = tag.strip_prefix('/') {
                assert_eq!(open.pop(), Some(closed), "</{closed}>");
            } else if !(tag.ends_with('/') || tag.starts_with('!') || matches!(name, "meta" | "br")) {
                open.push(name);
            }
        }
        assert!(open.is_empty(), "never closed: {open:?}");
    }

    /// Nothing is fetched when the page is opened.
    pub fn assert_self_contained(html: &str) {
        for outside in ["http:", "https:", "src=", "href=", "<script", "<link", "@import", "url("] {
            assert!(!html.contains(outside), "{outside}");
        }
    }

    #[test]
    fn pages_stand_alone_and_escape_names() {
        let mut page = Page::new("a <b> & c", "lead");
        page.heading("x < y");
        page.facts(&[("name", "1 < 2".to_string(), "\"mm\"")]);
        let html = page.finish();
        assert_balanced(&html);
        assert_self_contained(&html);
        assert!(html.contains("<title>a &lt;b&gt; &amp; c</title>") && html.contains("1 &lt; 2"));
    }
}
