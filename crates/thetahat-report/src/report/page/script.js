(() => {
  'use strict';
  const all = (selector, within = document) => [...within.querySelectorAll(selector)];
  const make = (tag, attributes = {}, text = '') => {
    const element = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
    element.textContent = text;
    return element;
  };
  const button = (text, label, act) => {
    const element = make('button', { type: 'button', 'aria-label': label, title: label }, text);
    element.addEventListener('click', act);
    return element;
  };

  // Links open the fold that they lead to; printing opens all folds.
  const open = () => {
    const target = location.hash.length > 1 && document.getElementById(decodeURIComponent(location.hash.slice(1)));
    const fold = target && target.closest('details');
    if (fold) { fold.open = true; fold.scrollIntoView(); }
  };
  addEventListener('hashchange', open);
  open();
  for (const link of all('nav a')) link.addEventListener('click', () => setTimeout(open));
  let closed = [];
  addEventListener('beforeprint', () => { closed = all('details:not([open])'); closed.forEach(d => { d.open = true; }); });
  addEventListener('afterprint', () => closed.forEach(d => { d.open = false; }));

  // Tables: sort by a column, filter rows, copy as CSV.
  const words = cell => cell.innerText.trim().replace(/\s+/g, ' ');
  const number = text => {
    const found = /^[*+]?\s*(-?[\d.]+(?:e[-+]?\d+)?)/i.exec(text);
    return found ? parseFloat(found[1]) : NaN;
  };
  const compare = (a, b) => {
    const [x, y] = [number(a), number(b)];
    if (isNaN(x) !== isNaN(y)) return isNaN(x) ? 1 : -1;
    return isNaN(x) ? a.localeCompare(b, undefined, { numeric: true }) : x - y;
  };
  const rowsOf = table => all('tbody tr:not(.of-joint)', table);
  const sort = (table, column, header) => {
    const up = header.getAttribute('aria-sort') !== 'ascending';
    all('[aria-sort]', table).forEach(h => h.removeAttribute('aria-sort'));
    header.setAttribute('aria-sort', up ? 'ascending' : 'descending');
    const rows = rowsOf(table).map(row => [words(row.cells[column]), row]);
    rows.sort((a, b) => (up ? 1 : -1) * compare(a[0], b[0]));
    const body = table.tBodies[0];
    rows.forEach(([, row]) => body.append(row));
    table.classList.add('is-sorted');
  };
  const csv = table => {
    const line = row => [...row.cells].filter(c => !c.classList.contains('picture')).map(c => '"' + words(c).replace(/"/g, '""') + '"').join(',');
    const head = table.tHead.rows[table.tHead.rows.length - 1];
    return [head, ...rowsOf(table).filter(r => !r.hidden)].map(line).join('\n') + '\n';
  };
  const copy = async (text, done) => {
    try {
      await navigator.clipboard.writeText(text);
    } catch {
      const area = make('textarea');
      area.value = text;
      document.body.append(area);
      area.select();
      document.execCommand('copy');
      area.remove();
    }
    done();
  };
  for (const table of all('table.sortable')) {
    if (rowsOf(table).length < 2) continue;
    const title = table.caption.textContent;
    const head = table.tHead.rows[table.tHead.rows.length - 1];
    [...head.cells].forEach((header, column) => {
      if (!header.textContent.trim() || 'plain' in header.dataset) return;
      const sorter = make('button', { type: 'button' }, header.textContent);
      sorter.addEventListener('click', () => sort(table, column, header));
      header.replaceChildren(sorter);
    });
    const tools = make('div', { class: 'tools' });
    if (rowsOf(table).length > 8) {
      const filter = make('input', { type: 'search', placeholder: 'filter rows', 'aria-label': 'Filter the rows of ' + title });
      filter.addEventListener('input', () => rowsOf(table).forEach(row => {
        row.hidden = !row.textContent.toLowerCase().includes(filter.value.toLowerCase());
      }));
      tools.append(filter);
    }
    const copier = button('copy as CSV', 'copy as CSV: ' + title, () => copy(csv(table), () => {
      copier.textContent = 'copied';
      setTimeout(() => { copier.textContent = 'copy as CSV'; }, 1500);
    }));
    tools.append(copier);
    table.closest('.scroll').before(tools);
  }

  // Charts over time: one stretch of time for all charts of a figure, and the values under the pointer.
  const svg = (tag, attributes) => {
    const element = document.createElementNS(document.querySelector('svg').namespaceURI, tag);
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
    return element;
  };
  const round = step => {
    const power = 10 ** Math.floor(Math.log10(step));
    return [1, 2, 5, 10].map(m => m * power).find(s => s >= step * 0.999);
  };
  const points = path => {
    if (path.points) return path.points;
    const found = [];
    let x = 0, y = 0;
    for (const [, command, rest] of path.getAttribute('d').matchAll(/([Ml])([^Mlhvz]*)/g)) {
      const numbers = rest.match(/-?\d+/g).map(Number);
      if (command === 'M') x = y = 0;
      for (let i = 0; i + 1 < numbers.length; i += 2) found.push([x += numbers[i], y += numbers[i + 1]]);
    }
    return (path.points = found);
  };
  const nearest = (list, x) => {
    let [low, high] = [0, list.length - 1];
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (list[middle][0] <= x) low = middle; else high = middle;
    }
    return list[high] && Math.abs(list[high][0] - x) < Math.abs(list[low][0] - x) ? list[high] : list[low];
  };
  const values = make('div', { class: 'values', hidden: '' });
  document.body.append(values);

  class Time {
    constructor(figure) {
      this.charts = all('.chart', figure).map(chart => {
        const panels = all('.panel', chart).map(element => {
          const [, , width, height] = element.getAttribute('viewBox').split(' ').map(Number);
          const numbers = name => element.dataset[name].split(' ').map(Number);
          const pointer = svg('path', { class: 'pointer', d: '' });
          const chosen = svg('rect', { class: 'chosen', y: 0, height, width: 0 });
          element.prepend(svg('rect', { width, height, fill: 'transparent' }));
          element.append(chosen, pointer);
          return { element, width, height, x: numbers('x'), y: numbers('y'), pointer, chosen };
        });
        return { chart, panels, ticks: chart.querySelector('.x-ticks') };
      });
      this.range = [0, 1];
      const tools = make('span', { class: 'tools' });
      const zoom = factor => this.show(...this.range.map(v => (this.range[0] + this.range[1]) / 2 + factor * (v - (this.range[0] + this.range[1]) / 2)));
      const move = part => this.show(...this.range.map(v => v + part * (this.range[1] - this.range[0])));
      tools.append(
        button('+', 'Zoom in', () => zoom(0.5)), button('\u2212', 'Zoom out', () => zoom(2)),
        button('\u25C0', 'Earlier', () => move(-0.5)), button('\u25B6', 'Later', () => move(0.5)),
        button('whole', 'Show the whole time', () => this.show(0, 1)));
      figure.querySelector('.caption').append(tools);
      for (const chart of this.charts) for (const panel of chart.panels) this.listen(chart, panel);
    }

    listen(chart, panel) {
      let start = null;
      const partAt = event => {
        const box = panel.element.firstChild.getBoundingClientRect();
        return Math.min(1, Math.max(0, (event.clientX - box.left) / box.width));
      };
      const element = panel.element;
      element.addEventListener('pointerdown', event => {
        if (event.pointerType === 'mouse') { start = partAt(event); element.setPointerCapture(event.pointerId); }
      });
      element.addEventListener('pointermove', event => {
        const part = partAt(event);
        this.point(part);
        if (start === null) this.showValues(chart, part, event); else this.choose(start, part);
      });
      element.addEventListener('pointerup', event => {
        const end = partAt(event);
        this.choose(0, 0);
        if (start !== null && Math.abs(end - start) * this.charts[0].panels[0].width > 80 * (this.range[1] - this.range[0])) {
          this.show(Math.min(start, end), Math.max(start, end));
        }
        start = null;
      });
      element.addEventListener('dblclick', () => this.show(0, 1));
      element.addEventListener('pointerleave', () => { values.hidden = true; this.point(null); });
    }

    each(act) { for (const chart of this.charts) for (const panel of chart.panels) act(panel); }

    point(part) {
      this.each(p => p.pointer.setAttribute('d', part === null ? '' : `M${part * p.width} 0v${p.height}`));
    }

    choose(from, to) {
      this.each(p => {
        p.chosen.setAttribute('x', Math.min(from, to) * p.width);
        p.chosen.setAttribute('width', Math.abs(to - from) * p.width);
      });
    }

    showValues(chart, part, event) {
      const first = chart.panels[0];
      const lines = [`${(first.x[0] + part * (first.x[1] - first.x[0])).toFixed(3)} s`];
      chart.panels.forEach((panel, k) => {
        for (const path of all('path', panel.element)) {
          const name = path.getAttribute('class');
          if (!/^(measured|idim|didim|cli|clo)/.test(name) || getComputedStyle(path).display === 'none') continue;
          const found = nearest(points(path), part * panel.width);
          if (!found) continue;
          const value = panel.y[0] + (1 - found[1] / panel.height) * (panel.y[1] - panel.y[0]);
          lines.push(`${k ? 'residual ' : ''}${name}  ${Number(value.toPrecision(4))}`);
        }
      });
      values.textContent = lines.join('\n');
      values.hidden = false;
      const left = Math.min(event.clientX + 14, innerWidth - values.offsetWidth - 8);
      values.style.left = Math.max(4, left) + 'px';
      values.style.top = Math.max(4, event.clientY - values.offsetHeight - 12) + 'px';
    }

    show(from, to) {
      const width = Math.min(1, Math.max(to - from, 0.005));
      const start = Math.min(Math.max(from, 0), 1 - width);
      this.range = [start, start + width];
      for (const { chart, panels, ticks } of this.charts) {
        panels.forEach(p => p.element.setAttribute('viewBox', `${start * p.width} 0 ${width * p.width} ${p.height}`));
        const panel = panels[0];
        const [left, size] = ['x', 'width'].map(name => Number(panel.element.getAttribute(name)));
        const at = part => panel.x[0] + part * (panel.x[1] - panel.x[0]);
        const [low, high] = this.range.map(at);
        const step = round((high - low) / (size / 55));
        const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
        const last = panels[panels.length - 1].element;
        const bottom = Number(last.getAttribute('y')) + Number(last.getAttribute('height'));
        const marks = [];
        for (let k = Math.ceil(low / step); k * step <= high; k += 1) {
          const x = left + (k * step - low) / (high - low) * size;
          const text = svg('text', { x, y: bottom + 15, 'text-anchor': 'middle' });
          text.textContent = (k * step).toFixed(decimals);
          marks.push(text);
        }
        ticks.replaceChildren(...marks);
        const axis = chart.querySelector('.axis');
        const path = mark => `M${mark.getAttribute('x')} ${bottom}v4`;
        axis.setAttribute('d', `M${left} ${bottom}h${size}` + marks.map(path).join(''));
      }
    }
  }
  for (const figure of all('figure.zooms')) new Time(figure);
})();
