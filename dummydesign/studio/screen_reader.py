"""The script that gives screen readers what the parts of the page library lack: names, and lists that hold options."""

from __future__ import annotations

_SCRIPT = """
(() => {
  const mend = () => {
    for (const portal of document.querySelectorAll('[id^="q-portal--"]:not([role])')) {
      portal.setAttribute('role', 'region');
      portal.setAttribute('aria-label', 'choices');
    }
    // options lie in an element of their own, which the keyboard can enter and which is no option
    for (const inner of document.querySelectorAll('[role=listbox] > .q-virtual-scroll__content[tabindex]')) {
      inner.removeAttribute('tabindex');
      inner.setAttribute('role', 'presentation');
    }
    document.getElementById('q-loading-bar')?.setAttribute('aria-hidden', 'true');
  };
  new MutationObserver(mend).observe(document, {subtree: true, childList: true});
})();
"""


def reader_script() -> str:
    """Return the script, as an element of a page's head."""
    return f"<script>{_SCRIPT}</script>"
