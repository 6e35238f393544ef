"""Terms on the studio's pages: a word whose definition opens under the pointer, by keyboard focus and by touch."""

from __future__ import annotations

from html import escape

from dummydesign.report.html.glossary import marked_terms, terms

GLOSSARY_CSS = (
    "abbr.term{text-decoration:underline dotted;text-underline-offset:.2em;cursor:help}"
    "#term-tip{position:fixed;left:0;top:0;z-index:9999;max-width:min(20rem,92vw);padding:.35rem .6rem;"
    "background:var(--panel);color:var(--ink);border:1px solid var(--soft);border-radius:6px;"
    "font-size:.85rem;line-height:1.35}"
)
GLOSSARY_SCRIPT = """
(() => {
  if (window.termsRead) return;
  window.termsRead = true;
  let tip = null, open = null;
  const hide = () => { open = null; if (tip) tip.hidden = true; };
  const termOf = (event) => event.target instanceof Element ? event.target.closest('abbr.term') : null;
  function show(term) {
    if (!tip?.isConnected) {
      tip = document.createElement('div');
      tip.id = 'term-tip';
      tip.setAttribute('role', 'tooltip');
      document.body.append(tip);
    }
    open = term;
    tip.textContent = term.dataset.term;
    tip.hidden = false;
    const at = term.getBoundingClientRect(), wide = document.documentElement.clientWidth;
    const above = at.bottom + tip.offsetHeight > innerHeight;
    tip.style.left = Math.max(4, Math.min(at.left, wide - tip.offsetWidth - 4)) + 'px';
    tip.style.top = (above ? at.top - tip.offsetHeight : at.bottom) + 'px';
  }
  document.addEventListener('focusin', (event) => { const term = termOf(event); if (term) show(term); });
  document.addEventListener('focusout', (event) => { if (termOf(event)) hide(); });
  document.addEventListener('pointerover', (event) => {
    const term = termOf(event);
    if (term) show(term);
    else if (open && !tip.contains(event.target) && document.activeElement !== open) hide();
  });
  document.addEventListener('pointerdown', (event) => {
    const term = termOf(event);
    if (term) show(term); else hide();
  });
  document.addEventListener('keydown', (event) => { if (event.key === 'Escape') hide(); });
  document.addEventListener('scroll', hide, { passive: true, capture: true });
})();
"""


def term(word: str, text: str | None = None) -> str:
    """A term as HTML, with its definition at hand.

    Parameters
    ----------
    word : str
        Name or form of a term of the glossary, in any case.
    text : str, optional
        What is shown in its place. Escaped here.

    Raises
    ------
    KeyError
        When the glossary does not have it.
    """
    found = terms()[word.lower()]
    return (
        f'<abbr class="term" tabindex="0" aria-describedby="term-tip" data-term="{escape(found.text)}">'
        f"{escape(word if text is None else text)}</abbr>"
    )


def marked(text: str) -> str:
    """A text as HTML in which the first use of each term opens its definition under the pointer and by touch.

    These are no stops of the Tab key: by keyboard the same lines are at the end of each page.
    """
    parts, at = [], 0
    for start, end, found in marked_terms(text):
        definition = f'<abbr class="term" data-term="{escape(found.text)}">{escape(text[start:end])}</abbr>'
        parts += [escape(text[at:start]), definition]
        at = end
    return "".join([*parts, escape(text[at:])])


def glossary_head() -> str:
    """Style and script of the terms, for the head of every page."""
    return f"<style>{GLOSSARY_CSS}</style><script>{GLOSSARY_SCRIPT}</script>"
