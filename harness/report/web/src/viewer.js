// Motions of any runs, side by side and in step.
import * as THREE from 'three';
import {OrbitControls} from 'three/examples/jsm/controls/OrbitControls.js';

import {element, say, select} from './dom.js';
import {crossing_css, Panel, ramp_css} from './panel.js';

const kMostPanels = 6;
const kFirst = ['push', 'stretch', 'sweep', 'drop'];  // scenes that show a difference at once
const is_dark = () => getComputedStyle(document.body).backgroundColor.match(/\d+/g).slice(0, 3).every(c => Number(c) < 80);
const kViews = {
  front: [0, 0.12, 1],
  top: [0, 1, 0.001],
  corner: [0.75, 0.55, 0.8]
};
const kScales = {
  strain: [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1].map(v => ({value: v, text: `${100 * v} %`})),
  penetration: [1, 5, 20].map(v => ({value: v * 1e-3, text: `${v} mm`}))
};
/// Three digits; a value above 0 is never shown as 0.
const number = (v, unit) => v === 0 ? '0' : v < 1e-3 ? `<0.001 ${unit}` : `${v.toPrecision(3)} ${unit}`;
const percent = v => number(100 * v, '%'), millimetres = v => number(1e3 * v, 'mm');
const kWords = {
  stretch_max: ['strain', percent],
  contact_length_m: ['contour', millimetres],
  depth_m: ['depth', millimetres]
};

class Viewer {
  constructor(root, motions, results) {
    Object.assign(this, {
      root,
      motions,
      results,
      panels: [],
      time: 0,
      end: 0,
      speed: 1,
      playing: false,
      colouring: 'checks',
      most: {strain: 0.05, penetration: 5e-3},
      chosen: {},
      colliders: true,
      wires: false,
      follow: false,
      last: 0,
      stale: true
    });
    this.build();
    try {
      this.renderer = new THREE.WebGLRenderer({canvas: this.canvas, antialias: true, preserveDrawingBuffer: true});
    } catch (error) {
      this.root.replaceChildren(element(
          'p', {class: 'warning'}, 'Motions need WebGL, which this browser lacks or has disabled. The rest of the page is complete.'));
      this.broken = String(error);
      return;
    }
    this.renderer.setScissorTest(true);
    this.camera = new THREE.PerspectiveCamera(32, 1, 0.01, 200);
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.addEventListener('change', () => Object.assign(this, {stale: true}));
    this.controls.enablePan = true;
    new ResizeObserver(() => this.resize()).observe(this.stage);
    addEventListener('theme', () => Object.assign(this, {stale: true}));
    addEventListener('solvers', () => this.show_scene(this.scene));
    const frame = now => {
      this.tick(now);
      requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
  }

  build() {
    const scenes = [...new Set(this.motions.runs.map(c => c.scene))];
    this.canvas = element('canvas', {
      role: 'img',
      tabindex: '0',
      'aria-label': 'Motions side by side. Space: play or pause. Arrow keys: one frame. Home and End: first and last frame. ' +
          'Drag: rotate.'
    });
    this.overlay = element('div', {class: 'panels'});
    this.stage = element('div', {id: 'stage'}, this.canvas, this.overlay);
    this.play_button = element('button', {type: 'button', onclick: () => this.play(!this.playing)}, '▶ Play');
    this.scrub = element('input', {
      id: 'scrub',
      type: 'range',
      min: '0',
      max: '1',
      step: 'any',
      value: '0',
      'aria-label': 'Time',
      oninput: () => this.seek(Number(this.scrub.value))
    });
    this.clock = element('output', {id: 'clock'});
    this.legend = element('span', {class: 'bar'});
    this.scene_list = select('Scene, all solvers', scenes.map(s => ({value: s, text: s})), scenes[0], s => this.show_scene(s));
    this.add_button = element('button', {type: 'button', onclick: () => this.add()}, 'Add a motion');
    const colouring = select(
        'Colour', [{value: 'checks', text: 'checks'}, {value: 'strain', text: 'strain'}, {value: 'penetration', text: 'penetration'}],
        'checks', v => this.colour(v));
    this.colour_list = colouring.querySelector('select');
    this.lay_out(colouring);
    this.stage.addEventListener('keydown', e => this.key(e));
    this.colour('checks');
  }

  lay_out(colouring) {
    const toggle = (text, key) => {
      const box = element('input', {
        type: 'checkbox',
        onchange: () => {
          this[key] = box.checked;
          this.stale = true;
        }
      });
      box.checked = this[key];
      return element('label', {}, box, text);
    };
    this.root.append(
        element(
            'p', {class: 'note'},
            'Positions from the result files, thinned and rounded to fit this page; the details are below. ' +
                'Between stored frames, positions are interpolated linearly.'),
        element(
            'div', {class: 'bar'}, this.scene_list, this.add_button,
            element(
                'span', {class: 'bar', role: 'group', 'aria-label': 'View'},
                Object.keys(kViews).map(
                    v => element('button', {type: 'button', onclick: () => this.view(v)}, v[0].toUpperCase() + v.slice(1)))),
            element('button', {type: 'button', onclick: () => this.picture()}, 'PNG')),
        element(
            'div', {class: 'bar'}, colouring, this.legend, toggle('colliders', 'colliders'), toggle('grid', 'wires'),
            toggle('follow', 'follow')),
        this.stage, this.absent = element('p', {class: 'note'}),
        element(
            'div', {class: 'bar'}, this.play_button,
            element('button', {type: 'button', 'aria-label': 'One frame back', onclick: () => this.step(-1)}, '◂'),
            element('button', {type: 'button', 'aria-label': 'One frame forward', onclick: () => this.step(1)}, '▸'), this.scrub,
            this.clock,
            select(
                'Speed', [0.1, 0.25, 0.5, 1, 2].map(v => ({value: String(v), text: `${v}×`})), '1',
                v => Object.assign(this, {speed: Number(v)}))),
        element(
            'details', {}, element('summary', {}, 'Thinning and colours'), this.notes = element('ul', {class: 'note'}),
            element(
                'p', {class: 'note'},
                'Strain: greatest |length / rest − 1| of the edges along rows and columns at a vertex. Penetration: ' +
                    'depth in planes, spheres, boxes and capsules at vertices and at the middles of edges and triangles, without the margin; for meshes, ' +
                    'vertices with an edge that crosses the surface. Colours are computed from the rounded positions and ' +
                    'are approximate. The numbers under a motion and in the tables are computed from the full positions.'),
            ...this.motions.left_out.map(t => element('p', {class: 'note'}, `Left out: ${t}`))));
  }

  key(e) {
    if (e.target !== this.canvas) return;
    const keys = {
      ' ': () => this.play(!this.playing),
      ArrowLeft: () => this.step(-1),
      ArrowRight: () => this.step(1),
      Home: () => this.seek(0),
      End: () => this.seek(this.end)
    };
    if (!keys[e.key]) return;
    keys[e.key]();
    e.preventDefault();
  }

  /// All solvers on a scene, as many as fit; further settings only if there is room.
  async show_scene(scene) {
    this.scene = scene;
    const off = window.clothbench.state?.off ?? new Set(), runs = this.motions.runs.filter(c => c.scene === scene && !off.has(c.solver));
    const first = runs.filter((c, k) => runs.findIndex(d => d.solver === c.solver) === k), others = runs.filter(c => !first.includes(c));
    const list = this.scene_list.querySelector('select');
    list.value = scene;
    await this.set([...first, ...others].slice(0, Math.min(kMostPanels, Math.max(first.length, 2))));
    this.view('corner');
    const shown_here = new Set(this.motions.runs.filter(c => c.scene === scene).map(c => c.solver));
    this.absent.textContent =
        [...new Map(this.results.filter(r => r.scene === scene && !shown_here.has(r.solver)).map(r => [r.solver, r])).values()]
            .map(r => `${r.solver}: ${r.status === 'ok' ? 'its motion is not in this page' : r.status}`)
            .join('; ');
    say(`${scene}: ${this.panels.length} motions`);
  }

  async set(runs) {
    const turn = this.turn = (this.turn ?? 0) + 1;
    const panels = await Promise.all(runs.map(c => Panel.load(this.motions, c)));
    if (turn !== this.turn) return panels.forEach(p => p.dispose());  // the user chose again meanwhile
    this.panels.forEach(p => p.dispose());
    this.panels = panels;
    this.arrange();
    this.seek(0);
  }

  async add() {
    const used = this.panels.map(p => p.motion.run);
    const next =
        this.motions.runs.find(c => !used.includes(c) && c.scene === used[0]?.scene) ?? this.motions.runs.find(c => !used.includes(c));
    if (next && this.panels.length < kMostPanels) await this.set([...used, next]);
  }

  replace(k, run) {
    const runs = this.panels.map(p => p.motion.run);
    if (run)
      runs[k] = run;
    else
      runs.splice(k, 1);
    return this.set(runs);
  }

  /// Runs of one scene keep their relative positions; the centres of different scenes are aligned.
  arrange() {
    this.end = Math.max(0, ...this.panels.map(p => p.motion.time_s.at(-1)));
    this.scrub.max = String(this.end || 1);
    this.radius = 0.1;
    this.middles = {};
    for (const p of this.panels) {
      const box = p.view_box();
      this.middles[p.motion.run.scene] ??= box.getCenter(new THREE.Vector3()).negate();
      this.radius = Math.max(this.radius, box.getSize(new THREE.Vector3()).length() / 2);
    }
    this.colour(this.colouring);
    const columns = this.columns =
              Math.min(this.panels.length === 4 ? 2 : 3, this.panels.length, Math.max(1, Math.floor(this.stage.clientWidth / 230))),
          rows = this.rows = Math.ceil(this.panels.length / Math.max(columns, 1));
    this.overlay.style.grid = `repeat(${rows}, 1fr) / repeat(${columns}, 1fr)`;
    this.overlay.replaceChildren(...this.panels.map((p, k) => this.label(p, k)));
    this.notes.replaceChildren(...this.panels.map(p => element('li', {}, `${this.name(p.motion.run)}: ${p.motion.thinning()}.`)));
    this.add_button.disabled = this.panels.length >= kMostPanels || this.panels.length >= this.motions.runs.length;
    this.resize();
  }

  name(run) { return `${run.scene} · ${run.label}`; }

  label(panel, k) {
    const runs = this.motions.runs,
          groups = [...new Set(runs.map(c => c.scene))].map(
              s => element(
                  'optgroup', {label: s},
                  runs.map(
                      (c, n) =>
                          c.scene === s ? element('option', {value: String(n), selected: c === panel.motion.run}, this.name(c)) : null)));
    const list = element('select', {'aria-label': `Motion ${k + 1}`, onchange: () => this.replace(k, runs[Number(list.value)])}, groups);
    const close = element('button', {type: 'button', 'aria-label': `Remove motion ${k + 1}`, onclick: () => this.replace(k, null)}, '×');
    panel.readout = element('output', {});
    return element('div', {class: 'panel'}, element('div', {}, list, this.panels.length > 1 ? close : null), panel.readout);
  }

  resize() {
    if (this.broken) return;
    const width = this.stage.clientWidth || 800, tile = width / Math.max(this.columns || 1, 1);
    const height = Math.round(Math.min(tile * (this.columns > 1 ? 1.05 : 0.6), 460)) * (this.rows || 1);
    this.stage.style.height = `${height}px`;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio || 1, 2));
    this.renderer.setSize(width, height, false);
    this.stale = true;
  }

  view(name) {
    const away = this.radius / Math.sin(THREE.MathUtils.degToRad(this.camera.fov / 2)) * 1.05;
    const tile = this.stage.clientWidth / this.columns / (this.stage.clientHeight / this.rows);
    this.controls.target.set(0, 0, 0);
    const [x, y, z] = kViews[name], [side_x, side_z] = name === 'corner' ? this.panels[0]?.side() ?? [1, 1] : [1, 1];
    this.camera.position.set(x * side_x, y, z * side_z).normalize().multiplyScalar(0.85 * away / Math.min(1, tile));
    this.camera.up.set(0, 1, 0);
    this.controls.update();
    this.stale = true;
  }

  colour(kind) {
    this.colouring = kind;
    this.colour_list.value = kind;
    this.legend.replaceChildren();
    if (kind === 'strain' && !this.chosen.strain) {
      // The least that holds nine of ten frames' greatest strain to a half.
      const all = this.panels.flatMap(p => p.motion.run.metrics.stretch_max ?? []).filter(v => v !== null).sort((a, b) => a - b);
      const most = all[Math.floor(0.9 * all.length)] ?? 0.05;
      this.most.strain = (kScales.strain.find(s => s.value >= most / 2) ?? kScales.strain.at(-1)).value;
    }
    if (kind !== 'checks') {
      const scale = select('0 to', kScales[kind].map(s => ({value: String(s.value), text: s.text})), String(this.most[kind]), v => {
        this.most[kind] = Number(v);
        this.chosen[kind] = true;
        this.stale = true;
      });
      this.legend.append(
          element(
              'span',
              {class: 'ramp', style: `background: ${ramp_css}`, role: 'img', 'aria-label': 'colour ramp from dark violet to yellow'}),
          scale);
      if (kind === 'penetration')
        this.legend.append(
            element('span', {class: 'ramp', style: `background: ${crossing_css}; width: .9rem`}),
            element('span', {class: 'note'}, 'crosses a mesh'));
    }
    this.stale = true;
  }

  play(on) {
    if (on && this.time >= this.end) this.time = 0;
    this.playing = on;
    this.play_button.textContent = on ? '❚❚ Pause' : '▶ Play';
  }

  seek(time) {
    this.time = Math.min(Math.max(time, 0), this.end);
    this.stale = true;
  }

  /// To the next stored frame of the first motion.
  step(direction) {
    this.play(false);
    const t = this.panels[0]?.motion.time_s ?? [0], slack = 1e-9;
    const next = direction > 0 ? t.find(x => x > this.time + slack) : t.findLast(x => x < this.time - slack);
    if (next !== undefined) this.seek(next);
  }

  tick(now) {
    const passed = Math.min((now - this.last) / 1000, 0.1);
    this.last = now;
    if (this.playing) {
      this.seek(this.time + passed * this.speed);
      if (this.time >= this.end) this.play(false);
    }
    if (this.stale) this.draw();
  }

  draw() {
    this.stale = false;
    if (!this.panels.length) return;
    this.scrub.value = String(this.time);
    this.clock.textContent = `${this.time.toFixed(3)} s of ${this.end.toFixed(2)} s`;
    this.scrub.setAttribute('aria-valuetext', this.clock.textContent);
    const width = this.stage.clientWidth / this.columns, height = this.stage.clientHeight / this.rows;
    this.camera.aspect = width / height;
    this.camera.near = this.radius / 50;
    this.camera.far = this.radius * 100;
    this.camera.updateProjectionMatrix();
    this.panels.forEach((p, k) => {
      const shown = p.show(this.time, this.colouring, this.most[this.colouring]);
      if (this.follow)
        p.middle(p.scene.position).negate();
      else
        p.scene.position.copy(this.middles[p.motion.run.scene]);
      p.group.visible = this.colliders;
      p.wires.visible = this.wires;
      p.scene.background = new THREE.Color(is_dark() ? 0x1a2028 : 0xf2f4f6);
      p.wires.material.color.set(is_dark() ? 0xffffff : 0x000000);
      p.readout.textContent = this.readout(p, shown);
      const x = (k % this.columns) * width, y = this.stage.clientHeight - (Math.floor(k / this.columns) + 1) * height;
      this.renderer.setViewport(x, y, width, height);
      this.renderer.setScissor(x, y, width, height);
      this.renderer.render(p.scene, this.camera);
    });
  }

  readout(panel, shown) {
    const {run} = panel.motion, [f] = panel.motion.place(this.time), words = [];
    if (run.status !== 'ok') words.push(run.failed_frame >= 0 ? `${run.status} at frame ${run.failed_frame}` : run.status);
    for (const [key, [word, text]] of Object.entries(kWords)) {
      const v = run.metrics[key]?.[f];
      if (v !== undefined && v !== null) words.push(`${word} ${text(v)}`);
    }
    if (shown?.crossing) words.push(`${shown.crossing} vertices on a crossing edge`);
    return words.join(' · ') || run.sides;
  }

  picture() {
    this.draw();
    const link = element('a', {href: this.canvas.toDataURL('image/png'), download: `${this.panels[0]?.motion.run.scene ?? 'motion'}.png`});
    link.click();
  }
}

window.clothbench_viewer = (root, motions, rows) => {
  const viewer = new Viewer(root, motions, rows);
  if (!viewer.broken) {
    const touching = motions.runs.filter(c => c.colliders !== undefined && c.setting !== 'all-on');
    const run = kFirst.map(word => touching.find(c => c.scene.includes(word))).find(Boolean) ?? touching[0] ?? motions.runs[0];
    viewer.ready = viewer.show_scene(run.scene);
  }
  return viewer;
};
