"""The script that every page of the studio has: it tells a tab of an ended studio what to do."""

from __future__ import annotations

RESTARTED = "The studio was restarted. Open the address that it printed on the terminal; close this tab."

_SCRIPT = """
(() => {
  const home = '/' + location.pathname.split('/')[1];
  const asking = setInterval(async () => {
    if (!window.did_handshake || window.socket.connected) return;
    let answer;
    try { answer = await fetch(home + '/alive', {cache: 'no-store'}); } catch { return; }
    if (answer.status !== 403) return;
    clearInterval(asking);
    window.socket.disconnect();
    document.getElementById('popup')?.remove();
    const bar = document.createElement('div');
    bar.textContent = TEXT;
    bar.setAttribute('role', 'alert');
    bar.dataset.test = 'restarted';
    bar.style.cssText = 'position:fixed;inset:0 0 auto;z-index:9999;padding:1rem;background:#8a1c1c;color:#fff;'
      + 'font:600 1rem system-ui;text-align:center';
    document.body.append(bar);
  }, 2000);
})();
"""


def page_script() -> str:
    """Return the script, as an element of a page's head."""
    from json import dumps

    return f"<script>{_SCRIPT.replace('TEXT', dumps(RESTARTED))}</script>"
