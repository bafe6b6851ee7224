// What a page consists of, without its numbers.

/** Sections, counts and headings of an open page, in the order of the page. */
export function structureOf(page) {
  return page.evaluate(() => {
    const text = (element) => element.textContent.replace(/\s+/g, " ").trim();
    const count = (selector) => document.querySelectorAll(selector).length;
    return {
      sections: count("main section"),
      figures: count("figure"),
      drawings: count("svg[role=img]"),
      tables: count("table"),
      folds: count("details"),
      scripts: count("script"),
      headings: [...document.querySelectorAll("h1, h2, h3")].map((h) => `${h.localName} ${text(h)}`),
    };
  });
}
