(() => {
  const data = JSON.parse(document.getElementById('rows').textContent);
  const tip = document.getElementById('tip');
  const order = Object.keys(data.rows).map(Number);
  const plots = [...document.querySelectorAll('figure > svg')].map(svg => {
    const points = [];
    for (const path of svg.querySelectorAll('path[data-rows]')) {
      const rows = path.dataset.rows.split(' ').map(list =>
        list.split(',').map(Number).filter(row => row >= 0));
      const places = path.getAttribute('d').matchAll(/M(-?[\d.]+) (-?[\d.]+)/g);
      [...places].forEach((m, i) => points.push({ x: +m[1], y: +m[2], rows: rows[i], path }));
    }
    return { svg, points };
  });
  const visible = point => getComputedStyle(point.path).display !== 'none';
  let chosen = null;

  function choose(row) {
    document.querySelectorAll('.here').forEach(ring => ring.remove());
    chosen = row;
    for (const { svg, points } of row === null ? [] : plots) {
      for (const point of points) {
        if (!point.rows.includes(row) || !visible(point)) continue;
        const ring = document.createElementNS(svg.namespaceURI, 'circle');
        ring.setAttribute('class', 'here');
        ring.setAttribute('cx', point.x);
        ring.setAttribute('cy', point.y);
        ring.setAttribute('r', 6);
        svg.append(ring);
      }
    }
  }

  function describe(row, x, y) {
    tip.replaceChildren();
    const table = tip.appendChild(document.createElement('table'));
    (data.rows[row] || []).forEach((value, i) => {
      if (value === null || value === '') return;
      const line = table.insertRow();
      line.insertCell().textContent = data.names[i];
      line.insertCell().textContent = value;
    });
    tip.hidden = false;
    const { offsetWidth: width, offsetHeight: height } = tip;
    tip.style.left = Math.max(4, x + 16 + width > innerWidth ? x - width - 16 : x + 16) + 'px';
    tip.style.top = Math.max(4, Math.min(y + 16, innerHeight - height - 4)) + 'px';
  }

  function nearest({ svg, points }, event) {
    const box = svg.getBoundingClientRect(), scale = svg.viewBox.baseVal.width / box.width;
    const x = (event.clientX - box.left) * scale, y = (event.clientY - box.top) * scale;
    let best = null, least = 12 * 12;
    for (const point of points) {
      const far = (point.x - x) ** 2 + (point.y - y) ** 2;
      if (far < least && point.rows.length && visible(point)) [best, least] = [point, far];
    }
    return best && best.rows[0];
  }

  for (const plot of plots) {
    const follow = event => {
      const row = nearest(plot, event);
      if (row === null) tip.hidden = true;
      else describe(row, event.clientX, event.clientY);
      if (row !== chosen) choose(row);
    };
    plot.svg.addEventListener('pointermove', follow);
    plot.svg.addEventListener('pointerdown', follow);
    plot.svg.addEventListener('pointerleave', () => { tip.hidden = true; });
  }
  document.addEventListener('keydown', event => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (event.key === 'Escape') { choose(null); tip.hidden = true; }
    if (!step || chosen === null || event.target.tagName === 'INPUT') return;
    const next = order[order.indexOf(chosen) + step];
    if (next === undefined) return;
    choose(next);
    const { left, top } = tip.getBoundingClientRect();
    if (!tip.hidden) describe(next, left - 16, top - 16);
    event.preventDefault();
  });
  for (const form of document.querySelectorAll('.switch')) {
    form.hidden = false;
    form.addEventListener('change', event => {
      document.body.dataset.show = event.target.value;
      choose(chosen);
    });
  }
})();
