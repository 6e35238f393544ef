// What every page of the studio runs: state in address and links, definitions of terms, help for screen readers.
let stateQuery = '';

function keepState(query, more) {
  stateQuery = query;
  history.replaceState(history.state, '', '?' + [query, more].filter(Boolean).join('&'));
}

// a slider moved: new texts by the place where they are, and what changed of the plots
function follow([texts, changes]) {
  for (const [id, text] of Object.entries(texts)) {
    const place = document.getElementById(id);
    if (place && place.innerHTML !== text) place.innerHTML = text;
  }
  changePlots(changes);
}

// every plot can be saved: as it is seen, and its values
function plotDrawn(div) {
  const word = (text) => `"${String(text ?? '').replaceAll('"', '""')}"`, box = document.createElement('span');
  const name = (axis) => (axis.title?.text || '').replace('<br>', ' ');
  const made = {
    PNG: () => Plotly.toImage(div, { format: 'png', scale: 2, width: div.clientWidth, height: div.clientHeight }),
    CSV: () => {
      const { data, layout } = div.spec, rows = [['series', name(layout.xaxis), name(layout.yaxis)].map(word)];
      for (const [n, one] of data.entries()) {
        // a band is two curves, of which the upper one has the name
        const named = one.name ? one : data[n + 1] || one, end = named.fill ? (named === one ? ', high' : ', low') : '';
        (one.x || []).forEach((x, k) => rows.push([word(`${named.name ?? ''}${end}`), x, one.y?.[k]]));
      }
      return URL.createObjectURL(new Blob([rows.map((row) => row.join()).join('\n') + '\n'], { type: 'text/csv' }));
    },
  };
  box.className = 'save';
  for (const kind of Object.keys(made)) {
    const button = document.createElement('button'), link = document.createElement('a');
    button.type = 'button';
    button.textContent = kind;
    button.dataset.test = `save-${kind.toLowerCase()}`;
    button.setAttribute('aria-label', `save ${div.closest('figure').querySelector('strong').textContent} as ${kind}`);
    button.onclick = async () => {
      link.href = await made[kind]();
      link.download = `${div.dataset.name}.${kind.toLowerCase()}`;
      link.click();
    };
    box.append(button);
  }
  div.closest('figure').querySelector('figcaption').prepend(box);
}

// links that carry the state get it when they are used: panels come and go, and the state changes meanwhile
for (const kind of ['pointerdown', 'focusin', 'click']) addEventListener(kind, (event) => {
  const link = event.target.closest?.('a[data-state]');
  if (link) link.setAttribute('href', link.getAttribute('href').split('?')[0] + '?' + stateQuery);
}, true);

// on a phone the steps do not fit beside each other: the one that is open is moved into sight
addEventListener('load', () => setTimeout(() => {
  document.querySelector('nav [aria-current]')?.scrollIntoView({ inline: 'center', block: 'nearest' });
}, 300));

// roles that Quasar leaves out
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
  new MutationObserver(mend).observe(document, { subtree: true, childList: true });
})();

// a studio that was restarted has another key: the tab cannot go on
(() => {
  const home = '/' + location.pathname.split('/')[1];
  const asking = setInterval(async () => {
    if (!window.did_handshake || window.socket.connected) return;
    let answer;
    try { answer = await fetch(home + '/alive', { cache: 'no-store' }); } catch { return; }
    if (answer.status !== 403) return;
    clearInterval(asking);
    window.socket.disconnect();
    document.getElementById('popup')?.remove();
    const bar = document.createElement('div');
    bar.textContent = 'The studio was restarted. Open the address that it printed on the terminal; close this tab.';
    bar.setAttribute('role', 'alert');
    bar.dataset.test = 'restarted';
    bar.style.cssText = 'position:fixed;inset:0 0 auto;z-index:9999;padding:1rem;background:#8a1c1c;color:#fff;'
      + 'font:600 1rem system-ui;text-align:center';
    document.body.append(bar);
  }, 2000);
})();

// definitions of terms: under the pointer, by keyboard focus and by touch
(() => {
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
