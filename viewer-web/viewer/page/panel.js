// The controls: what they show, and what they tell the viewer.

import { count, share, short } from './format.js';

const $ = (id) => document.getElementById(id);

/** Powers of ten on the sliders of the budget. */
const power = (slider) => 10 ** Number(slider.value);

export class Panel {
  /** @param {{viewer: any, open: (file: File) => void, focus: () => void}} host */
  constructor(host) {
    this.host = host;
    this.selected = null;
    for (const radio of document.querySelectorAll('input[name="method"]')) {
      radio.addEventListener('change', () => this.apply());
    }
    for (const radio of document.querySelectorAll('input[name="budget"]')) {
      radio.addEventListener('change', () => this.apply());
    }
    for (const id of ['quality', 'triangles', 'milliseconds', 'tau', 'proxies', 'freeze']) {
      $(id).addEventListener('input', () => this.apply());
    }
    $('frame-all').addEventListener('click', () => host.viewer.frame_all(false));
    $('hide').addEventListener('click', () => this.hide());
    $('show-all').addEventListener('click', () => this.showAll());
    for (const id of ['open', 'welcome-open']) $(id).addEventListener('click', () => $('file-input').click());
    $('file-input').addEventListener('change', (event) => {
      const [file] = event.target.files;
      event.target.value = '';
      if (file) host.open(file);
    });
    $('fold').addEventListener('click', () => {
      const open = $('panel').classList.toggle('open');
      $('fold').setAttribute('aria-expanded', String(open));
    });
    const narrow = matchMedia('(max-width: 720px)');
    const fold = () => $('fold').setAttribute('aria-expanded', String(!narrow.matches || $('panel').classList.contains('open')));
    narrow.addEventListener('change', fold);
    fold();
    $('quality').value = JSON.parse(host.viewer.figures()).quality;
    this.apply();
  }

  checked(name) {
    return document.querySelector(`input[name="${name}"]:checked`).value;
  }

  /** Tells the viewer what the controls say. */
  apply() {
    const viewer = this.host.viewer;
    viewer.set_method(this.checked('method'));
    viewer.set_quality(Number($('quality').value));
    $('quality-value').value = Number($('quality').value).toFixed(2);
    $('quality').disabled = this.checked('method') !== 'visibility';
    const kind = this.checked('budget');
    $('triangles-row').hidden = kind !== 'triangles';
    $('milliseconds-row').hidden = kind !== 'milliseconds';
    $('triangles-value').value = short(power($('triangles')));
    $('milliseconds-value').value = `${power($('milliseconds')).toFixed(1)} ms`;
    const amount = { none: 0, triangles: power($('triangles')), milliseconds: power($('milliseconds')) }[kind];
    viewer.set_budget(kind, amount);
    $('tau').disabled = !$('proxies').checked;
    $('tau-value').value = `${Number($('tau').value).toFixed(1)} px`;
    viewer.set_proxies($('proxies').checked, Number($('tau').value));
    viewer.set_freeze($('freeze').checked);
  }

  /** A file was opened. @param {string} name */
  opened(name) {
    const figures = JSON.parse(this.host.viewer.figures());
    document.title = `${name} – svs viewer`;
    $('file').textContent = name;
    $('scene').textContent = `${count(figures.objects)} objects, ${short(figures.sceneTriangles)} triangles, ${figures.baked ? 'baked' : 'not baked'}`;
    $('notice').textContent = figures.notice ?? (figures.baked ? '' : 'No baked visibility: run “svs build” on the file. Culled by the frustum alone.');
    $('notice').hidden = $('notice').textContent === '';
    $('proxies-group').disabled = !figures.hasProxies;
    $('proxies-group').hidden = !figures.hasProxies;
    $('freeze').checked = false;
    if (figures.recommended !== null) $('quality').value = figures.recommended;
    this.select(null);
    this.apply();
  }

  nextMethod() {
    const radios = [...document.querySelectorAll('input[name="method"]')];
    const at = radios.findIndex((radio) => radio.checked);
    radios[(at + 1) % radios.length].checked = true;
    this.apply();
  }

  toggleFreeze() {
    $('freeze').checked = !$('freeze').checked;
    this.apply();
  }

  /** @param {number | null} object */
  select(object) {
    this.selected = object;
    const viewer = this.host.viewer;
    viewer.select(object ?? undefined);
    $('hide').disabled = object === null;
    $('object').textContent = object === null
      ? 'Click one to select it.'
      : `${viewer.name(object) ?? `object ${object}`}, ${count(viewer.triangles_of(object))} triangles`;
    $('object').classList.toggle('faint', object === null);
  }

  hide() {
    if (this.selected === null) return;
    this.host.viewer.set_hidden(this.selected, true);
    this.select(null);
    $('show-all').disabled = false;
  }

  showAll() {
    this.host.viewer.show_all();
    $('show-all').disabled = true;
  }

  /** Figures of the last frame. @param {any} f */
  show(f) {
    const frame = f.frameMs === null ? '–' : `${f.frameMs.toFixed(1)} ms`;
    const part = share(f.drawnObjects, f.objects);
    $('f-objects').textContent = `${count(f.drawnObjects)} (${part})`;
    $('f-triangles').textContent = `${count(f.triangles)} (${share(f.triangles, f.sceneTriangles)})`;
    $('f-draws').textContent = count(f.draws);
    $('f-cull').textContent = `${count(f.cullUs)} µs`;
    if (f.frameMs !== null) $('f-frame').textContent = frame;
    $('f-missing').textContent = `${f.estimatedMissingPpm.toFixed(0)} ppm`;
    $('f-hidden').textContent = count(f.hidden);
    $('headline').textContent = `${short(f.triangles)} of ${short(f.sceneTriangles)} triangles, ${count(f.draws)} draws, ${frame}`;
  }
}
