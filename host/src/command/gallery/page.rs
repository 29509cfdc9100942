// SPDX-License-Identifier: MIT OR Apache-2.0
//! The page: all pictures with what made them and how long it took.

use super::album::Section;
use crate::command::CommandError;
use crate::formats::write_whole;
use std::fmt::Write as _;
use std::path::Path;

const STYLE: &str = "\
:root{color-scheme:dark}\
body{margin:0;background:#15171a;color:#d9d6cf;font:15px/1.5 system-ui,sans-serif}\
main{max-width:1360px;margin:0 auto;padding:32px 24px}\
h1{font-weight:500;margin:0 0 4px}h2{font-weight:500;margin:48px 0 8px}\
p{margin:0 0 12px;color:#a5a198}\
.first img{width:100%}\
.sheet{display:grid;grid-template-columns:repeat(auto-fill,minmax(300px,1fr));gap:16px;margin-top:16px}\
figure{margin:0}img{width:100%;display:block;border-radius:3px;background:#000}\
figcaption{font-size:13px;color:#a5a198;padding:4px 0}\
table{border-collapse:collapse;font-size:13px;margin-top:12px}td{padding:2px 18px 2px 0}td+td{text-align:right}\
";

/// Writes the page.
pub fn write(path: &Path, adapter: &str, size: [u32; 2], sections: &[Section]) -> Result<(), CommandError> {
    let page = render(adapter, size, sections).map_err(CommandError::failure)?;
    write_whole(path, |writer| writer.write_all(page.as_bytes())).map_err(CommandError::failure)
}

fn render(adapter: &str, [width, height]: [u32; 2], sections: &[Section]) -> Result<String, std::fmt::Error> {
    let mut page = String::new();
    writeln!(
        page,
        "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>Airlight gallery</title>"
    )?;
    writeln!(page, "<style>{STYLE}</style><main><h1>Airlight gallery</h1>")?;
    writeln!(page, "<p>{width}x{height} pixels on {}</p>", escape(adapter))?;
    for section in sections {
        let Section { folder, title, about, columns, pictures, facts } = section;
        writeln!(page, "<section><h2>{}</h2><p>{folder}: {}</p>", escape(title), escape(about))?;
        for (index, (file, caption)) in pictures.iter().enumerate() {
            let class = if index == 0 { " class=\"first\"" } else { "" };
            let caption = escape(caption);
            writeln!(
                page,
                "<figure{class}><a href=\"{folder}/{file}\"><img src=\"{folder}/{file}\" alt=\"{caption}\"></a>\
                 <figcaption>{caption}</figcaption></figure>"
            )?;
            if index == 0 {
                let style = columns
                    .map(|columns| format!(" style=\"grid-template-columns:repeat({columns},1fr)\""))
                    .unwrap_or_default();
                writeln!(page, "<div class=\"sheet\"{style}>")?;
            }
        }
        page.push_str("</div><table>\n");
        for (what, value) in facts {
            writeln!(page, "<tr><td>{}</td><td>{}</td></tr>", escape(what), escape(value))?;
        }
        page.push_str("</table></section>\n");
    }
    page.push_str("</main></html>\n");
    Ok(page)
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
