// The motions of one scene, side by side and synchronised: one panel per run.
import * as THREE from 'three';
import {OrbitControls} from 'three/examples/jsm/controls/OrbitControls.js';
import {SVGRenderer} from 'three/examples/jsm/renderers/SVGRenderer.js';

import {button, element, say, select} from './dom.js';
import {number, unique} from './look.js';
import {load_colliders, Motion} from './motion.js';
import {crossing_css, Panel, ramp_css} from './panel.js';
import {reproduce} from './tables.js';

const kColours = ['checks', 'strain', 'penetration'];
const kStrains = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1], kDepth_m = 5e-3;  // upper ends of the colour ramp
const small = v => v > 0 && v < 1e-3 ? '<0.001' : number(v);
const mm = (name, v) => `${name} ${small(1e3 * v)} mm`;
const kReadouts = {stretch_max: v => `strain ${small(100 * v)} %`, contact_length_m: v => mm('contour', v), depth_m: v => mm('depth', v)};

class Viewer {
  constructor(root, motions, rows) {
    for (const m of motions.runs) m.row = rows[m.run];
    Object.assign(this, {root, motions, rows, panels: [], time: 0, end: 0, playing: false, colouring: 'checks', most: 1, last: 0, stale: true});
    this.build();
    const context = this.canvas.getContext('webgl2', {antialias: true, preserveDrawingBuffer: true});
    if (context) this.renderer = new THREE.WebGLRenderer({canvas: this.canvas, context, alpha: true});
    else this.root.prepend(element('p', {class: 'warning'}, 'This browser has no WebGL: motions are drawn slowly, coloured by the direction of the surface.'));
    this.renderer?.setScissorTest(true);
    this.camera = new THREE.PerspectiveCamera(32, 1, 0.01, 200);
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.addEventListener('change', () => this.stale = true);
    addEventListener('solvers', () => this.show_scene(this.scene));
    new ResizeObserver(() => this.resize()).observe(this.stage);
    const loop = now => (this.tick(now), requestAnimationFrame(loop));
    requestAnimationFrame(loop);
  }

  build() {
    const scenes = unique(this.motions.runs.map(m => m.row.scene)), options = list => list.map(s => ({value: s, text: s}));
    this.canvas = element('canvas', {role: 'img', 'aria-label': 'Motions side by side. Drag: rotate.'});
    this.overlay = element('div', {class: 'panels'});
    this.stage = element('div', {id: 'stage'}, this.canvas, this.overlay);
    this.play_button = button('▶ Play', null, () => this.play(!this.playing));
    const go = () => (this.play(false), this.seek(this.times[Number(this.scrub.value)]));
    this.scrub = element('input', {id: 'scrub', type: 'range', min: '0', 'aria-label': 'Time', oninput: go});
    this.clock = element('output', {id: 'clock'});
    this.legend = element('span', {class: 'bar'});
    this.scene_list = select('Scene', options(scenes), scenes[0], s => this.show_scene(s));
    this.root.append(
        element('div', {class: 'bar'}, this.scene_list, select('Colour', options(kColours), 'checks', v => this.colour(v)), this.legend),
        this.stage, this.absent = element('p', {class: 'note'}), element('div', {class: 'bar'}, this.play_button, this.scrub, this.clock),
        reproduce(window.clothbench.document, 'the motions', this.motions.runs.map(m => m.row)) ?? '',
        this.notes = element('ul', {class: 'note'}));
  }

  async show_scene(scene) {
    this.scene = scene;
    this.scene_list.querySelector('select').value = scene;
    const off = window.clothbench.state.off, here = this.motions.runs.filter(m => m.row.scene === scene);
    await this.set(here.filter(m => !off.has(m.row.solver)));
    // Solvers without a run in the report, such as engines that are not installed, are listed too.
    const {look, floor, baseline} = window.clothbench.document.solvers, known = Object.keys(look).filter(s => ![...floor, ...baseline].includes(s));
    const absent = unique([...this.rows.filter(r => !r.published).map(r => r.solver), ...known]).filter(s => !here.some(m => m.row.solver === s));
    const why = row => !row ? 'not run' : row.status === 'ok' ? 'its motion is not in this page' : row.status;
    this.absent.textContent = absent.map(s => `${s}: ${why(this.rows.find(r => r.scene === scene && r.solver === s))}`).join('; ');
    say(`${scene}: ${this.panels.length} motions`);
  }

  async set(entries) {
    const turn = this.turn = (this.turn ?? 0) + 1;
    const panels = await Promise.all(entries.map(async m => new Panel(await Motion.load(m), await load_colliders(this.motions.colliders[m.colliders]))));
    if (turn !== this.turn) return panels.forEach(p => p.dispose());  // the reader has chosen another scene meanwhile
    this.panels.forEach(p => p.dispose());
    this.panels = panels;
    this.arrange();
    this.seek(0);
  }

  /// All panels show the same part of the scene, around the initial cloths. A cloth that slides off a desk falls for metres; in a
  /// box around its whole path it would be a dot.
  arrange() {
    [this.times = [0]] = this.panels.map(p => p.motion.time_s).sort((a, b) => b.at(-1) - a.at(-1));
    this.end = this.times.at(-1);
    this.scrub.max = String(this.times.length - 1);
    const around = box => box.clone().expandByScalar(0.25 * Math.max(...box.getSize(new THREE.Vector3()).toArray()));
    const box = this.panels.reduce((all, p) => all.union(around(p.motion.box)), new THREE.Box3());
    this.radius = box.isEmpty() ? 1 : Math.max(0.1, box.getSize(new THREE.Vector3()).length() / 2);
    const count = this.panels.length;
    this.columns = Math.max(1, Math.min(count === 4 ? 2 : 3, count, Math.floor(this.stage.clientWidth / 230)));
    this.rows_of_panels = Math.max(1, Math.ceil(count / this.columns));
    this.overlay.style.grid = `repeat(${this.rows_of_panels}, 1fr) / repeat(${this.columns}, 1fr)`;
    this.overlay.replaceChildren(...this.panels.map(p => {
      p.readout = element('output', {});
      p.place = element('div', {class: 'panel'}, element('b', {}, p.motion.entry.row.label), p.readout);
      return p.place;
    }));
    const {left_out} = this.motions, notes = this.panels.map(p => `${p.motion.entry.row.label}: ${p.motion.thinning()}.`);
    if (left_out) notes.push(`${left_out} motions were left out, for lack of room or because they are not finite.`);
    this.notes.replaceChildren(...notes.map(n => element('li', {}, n)));
    this.colour(this.colouring);
    this.resize();
    // The camera is at the corner from which the cloth is in front of its colliders.
    const away = 0.9 * this.radius / Math.sin(THREE.MathUtils.degToRad(this.camera.fov / 2)), {target} = this.controls;
    const tile = this.stage.clientWidth / this.columns / (this.stage.clientHeight / this.rows_of_panels), [x, z] = this.panels[0]?.side() ?? [1, 1];
    box.getCenter(target);
    this.camera.position.set(0.75 * x, 0.55, 0.8 * z).setLength(away / Math.min(1, tile)).add(target);
    this.controls.update();
  }

  resize() {
    const width = this.stage.clientWidth || 800, tile = width / (this.columns ?? 1);
    const height = Math.round(Math.min(tile * (this.columns > 1 ? 1.05 : 0.6), 460)) * (this.rows_of_panels ?? 1);
    this.stage.style.height = `${height}px`;
    this.renderer?.setPixelRatio(Math.min(devicePixelRatio || 1, 2));
    this.renderer?.setSize(width, height, false);
    this.stale = true;
  }

  colour(kind) {
    Object.assign(this, {colouring: kind, stale: true});
    this.legend.replaceChildren();
    if (kind === 'checks') return;
    // The smallest ramp end that is at least half of the 90th percentile of the frames' maximum strains.
    const strains = this.panels.flatMap(p => p.motion.entry.metrics.stretch_max ?? []).filter(v => v !== null).sort((a, b) => a - b);
    const usual = strains[Math.floor(0.9 * strains.length)] ?? 0;
    this.most = kind === 'strain' ? kStrains.find(s => s >= usual / 2) ?? kStrains.at(-1) : kDepth_m;
    this.legend.append(
        '0', element('span', {class: 'ramp', style: `background: ${ramp_css}`, role: 'img', 'aria-label': 'from dark violet to yellow'}),
        kind === 'strain' ? `${100 * this.most} %` : `${1e3 * this.most} mm`);
    if (kind === 'penetration')
      this.legend.append(element('span', {class: 'ramp', style: `background: ${crossing_css}; width: .9rem`}), 'crosses a mesh');
  }

  play(on) {
    if (on && this.time >= this.end) this.time = 0;
    this.playing = on;
    this.play_button.textContent = on ? '❚❚ Pause' : '▶ Play';
  }

  seek(time) { Object.assign(this, {time: Math.min(Math.max(time, 0), this.end), stale: true}); }

  tick(now) {
    const passed = Math.min((now - this.last) / 1000, 0.1);
    this.last = now;
    if (this.playing) {
      this.seek(this.time + passed);
      if (this.time >= this.end) this.play(false);
    }
    if (this.stale) this.draw();
  }

  draw() {
    this.stale = false;
    if (!this.panels.length) return;
    this.scrub.value = String(this.times.findLastIndex(t => t <= this.time));
    this.clock.textContent = `${this.time.toFixed(3)} s of ${this.end.toFixed(2)} s`;
    this.scrub.setAttribute('aria-valuetext', this.clock.textContent);
    const width = this.stage.clientWidth / this.columns, height = this.stage.clientHeight / this.rows_of_panels;
    Object.assign(this.camera, {aspect: width / height, near: this.radius / 50, far: this.radius * 100});
    this.camera.updateProjectionMatrix();
    this.panels.forEach((p, k) => {
      const shown = p.show(this.time, this.colouring, this.most);
      p.readout.textContent = this.readout(p, shown);
      if (!this.renderer) return this.draw_svg(p, width, height);
      const x = (k % this.columns) * width, y = this.stage.clientHeight - (Math.floor(k / this.columns) + 1) * height;
      for (const set of ['setViewport', 'setScissor']) this.renderer[set](x, y, width, height);
      this.renderer.render(p.scene, this.camera);
    });
  }

  /// Draws a panel as SVG, for browsers without WebGL.
  draw_svg(p, width, height) {
    if (!p.svg) {
      p.svg = new SVGRenderer();
      p.lit = new THREE.MeshNormalMaterial({side: THREE.DoubleSide});  // SVGRenderer's lights leave one side of a cloth dark
      for (const c of p.colliders) c.object.traverse(o => o.material &&= new THREE.MeshBasicMaterial({color: p.solid.color}));
    }
    p.svg.setSize(width, height);
    p.svg.render(p.scene, this.camera);
    p.place.prepend(p.svg.domElement);
  }

  readout({motion}, shown) {
    const {row, metrics} = motion.entry, [f] = motion.place(this.time);
    return [
      row.status === 'ok' ? null : row.verdict, ...Object.entries(kReadouts).map(([name, text]) => metrics[name]?.[f] >= 0 ? text(metrics[name][f]) : null),
      this.colouring === 'penetration' && shown.crossing ? `${shown.crossing} vertices on a crossing edge` : null
    ].filter(Boolean).join(' · ');
  }
}

window.clothbench_viewer = (root, motions, rows) => {
  const viewer = new Viewer(root, motions, rows);
  // The first picture shows the middle of the motion, where the cloth touches something.
  viewer.ready = viewer.show_scene(rows[motions.first].scene).then(() => viewer.seek(viewer.end / 2));
  return viewer;
};
