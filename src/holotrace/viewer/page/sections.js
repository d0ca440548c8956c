// The controls beside the view, the hologram, the report and the quality.

import * as api from './api.js';
import { showConvergence } from './progress.js';
import { change, colourOf, eye, onChange, playRange, query, session, state } from './state.js';

const $ = id => document.getElementById(id);

function element(name, text = '', attributes = {}) {
  const made = document.createElement(name);
  made.textContent = text;
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  return made;
}

function setIfIdle(input, value) {
  if (document.activeElement !== input || Number(input.value) !== value) input.value = String(value);
}

/** Writes the state into the controls. */
export function writeControls() {
  const range = $('distance');
  const beyond = Math.abs(state.distance) * 0.2;
  if (state.distance > Number(range.max)) range.max = String(state.distance + beyond);
  if (state.distance < Number(range.min)) range.min = String(state.distance - beyond);
  range.value = String(state.distance);
  range.setAttribute('aria-valuetext', `${state.distance.toFixed(1)} mm`);
  setIfIdle($('distance-number'), Number(state.distance.toFixed(3)));
  setIfIdle($('pupil'), state.pupil);
  ['eye-x', 'eye-y', 'eye-z'].forEach((id, i) => setIfIdle($(id), state.eye[i]));
  setIfIdle($('focal'), state.focal);
  setIfIdle($('exposure'), state.exposure);
  $('orders').checked = state.hasOrders;
}

function readNumber(input, apply) {
  input.addEventListener('input', () => {
    const value = input.valueAsNumber;
    if (Number.isFinite(value) && value >= (input.min === '' ? -Infinity : Number(input.min))) apply(value);
  });
}

readNumber($('distance'), v => change({ distance: Number(v.toFixed(2)) }));
readNumber($('distance-number'), v => change({ distance: v }));
readNumber($('pupil'), v => change({ pupil: v }));
['eye-x', 'eye-y', 'eye-z'].forEach((id, i) => readNumber($(id), v => change({ eye: state.eye.map((e, k) => (k === i ? v : e)) })));
readNumber($('focal'), v => change({ focal: v }));
readNumber($('exposure'), v => change({ exposure: v }));
$('orders').addEventListener('change', () => change({ hasOrders: $('orders').checked }));
$('preset-eye').addEventListener('click', () => change(eye));
$('preset-all').addEventListener('click', () => change({ pupil: 0 }));
onChange(() => $('quality').classList.add('old'));  // figures of what was before

const wavelengthOf = item => item.wavelengths_m.join(' ');
const textOf = item => item.wavelengths_m.map(w => `${(w * 1e9).toFixed(1).replace(/\.0$/, '')} nm`).join(' + ');

// The holograms whose wavelength is ticked and whose frame is chosen.
function choose() {
  const ticked = new Set([...$('wavelengths').querySelectorAll('input:checked')].map(box => box.value));
  const frame = $('frames').value;
  const shown = session.items.map((item, i) => i)
    .filter(i => ticked.has(wavelengthOf(session.items[i])) && (frame === 'all' || session.items[i].frame === Number(frame)));
  if (shown.length === 0) { writeChoices(); return; }
  change({ shown: shown.length === session.items.length ? null : shown });
}

function writeChoices() {
  const isShown = i => !state.shown || state.shown.includes(i);
  for (const box of $('wavelengths').querySelectorAll('input'))
    box.checked = session.items.some((item, i) => wavelengthOf(item) === box.value && isShown(i));
}

/** Makes the controls that depend on the session. */
export function buildControls() {
  const wavelengths = new Map(session.items.map(item => [wavelengthOf(item), item]));
  $('wavelengths').replaceChildren(element('legend', 'Wavelengths'));
  for (const [value, item] of wavelengths) {
    const label = element('label'), box = element('input', '', { type: 'checkbox', value }), swatch = element('span', '', { class: 'swatch' });
    swatch.style.background = colourOf(item.wavelengths_m[0]);
    box.checked = true;
    box.addEventListener('change', choose);
    label.append(box, swatch, textOf(item));
    $('wavelengths').append(label);
  }
  const frames = [...new Set(session.items.map(item => item.frame))].sort((a, b) => a - b);
  $('frames').replaceChildren(element('option', `all ${frames.length}, averaged`, { value: 'all' }),
    ...frames.map(f => element('option', `only ${f + 1}`, { value: String(f) })));
  $('frames-label').hidden = frames.length < 2;
  $('frames').onchange = choose;
  const effects = [...new Set(session.items.flatMap(item => item.effects))];
  $('effects').replaceChildren(element('legend', 'Effects of the panel'));
  const own = session.items.flatMap(item => item.own_effects).filter(name => !state.knownEffects.has(name));
  state.effects = new Set([...state.effects, ...own].filter(name => effects.includes(name)));
  state.knownEffects = new Set(effects);
  for (const name of effects) {
    const label = element('label'), box = element('input', '', { type: 'checkbox', value: name });
    box.checked = state.effects.has(name);
    box.addEventListener('change', () => {
      if (box.checked) state.effects.add(name); else state.effects.delete(name);
      change({});
    });
    label.append(box, name);
    $('effects').append(label);
  }
  $('effects').hidden = effects.length === 0;
  $('orders').closest('label').hidden = session.items.every(item => item.is_field);
  $('panel-item').replaceChildren(...session.items.map((item, i) =>
    element('option', item.file ? `${item.file} (${textOf(item)})` : textOf(item), { value: String(i) })));
  $('panel-item-label').hidden = session.items.length < 2;
  const isField = session.items.length > 0 && session.items[0].is_field;
  $('panel-as').querySelector('[value=level]').hidden = isField;
  if (isField) $('panel-as').value = 'phase';
}

/** Shows the chosen hologram. */
export async function showPanel() {
  if (session.items.length === 0) return;
  const wanted = () => query({ item: $('panel-item').value || '0', as: $('panel-as').value });
  const asked = wanted();
  const picture = await api.picture(`panel?${asked}`).catch(() => null);
  if (!picture || asked !== wanted()) return;
  api.draw($('panel'), picture);
  $('panel').setAttribute('aria-label', `Hologram on the panel: ${$('panel-as').selectedOptions[0].text}, ${picture.columns} by ${picture.rows} pixels`);
}
$('panel-as').addEventListener('change', showPanel);
$('panel-item').addEventListener('change', showPanel);

const entry = (name, value) => { const box = element('div'); box.append(element('dt', name), element('dd', value)); return box; };

/** Shows how near a view is to its render. */
export function showQuality(metrics) {
  const entries = [];
  if (metrics.psnr_db !== undefined) {
    entries.push(entry('PSNR', metrics.psnr_db === null ? '∞' : `${metrics.psnr_db.toFixed(2)} dB`));
    entries.push(entry('SSIM', metrics.ssim.toFixed(3)));
    entries.push(entry('Speckle contrast', metrics.speckle_contrast.toFixed(3)));
  } else {
    entries.push(entry('Contrast of the picture', metrics.contrast.toFixed(3)));
  }
  $('quality').replaceChildren(...entries);
  $('quality').classList.remove('old');
}

/** Shows report.json: stages, times and warnings. */
export async function showReport() {
  const report = await api.json('report').catch(() => ({}));
  if (!report.stages) return;
  const table = element('table'), head = element('tr');
  head.append(element('th', 'Stage', { scope: 'col' }), element('th', 'Seconds', { scope: 'col', class: 'number' }));
  table.append(head);
  for (const stage of report.stages) {
    const row = element('tr'), name = element('td', stage.stage);
    for (const sentence of stage.warnings ?? []) name.append(element('div', sentence, { class: 'warning' }));
    const facts = Object.entries(stage).filter(([key, v]) => !['stage', 'seconds', 'warnings'].includes(key) && !Array.isArray(v));
    if (facts.length > 0) {
      const more = element('details');
      more.append(element('summary', `${facts.length} facts`));
      for (const [key, value] of facts) more.append(element('div', `${key}: ${value}`, { class: 'hint' }));
      name.append(more);
    }
    row.append(name, element('td', Number(stage.seconds).toFixed(2), { class: 'number' }));
    table.append(row);
  }
  $('report').replaceChildren(table);
  showConvergence(report.stages);
}

/** Shows the command line of the view, and sets the addresses of the downloads. */
export async function showCommand() {
  const asked = query();
  const { command } = await api.json(`command?${asked}`).catch(() => ({ command: '' }));
  if (asked !== query()) return;
  $('command').textContent = command || 'This view is not of holograms in files, so holotrace show cannot make it.';
  $('copy').hidden = !command;
  for (const ending of ['png', 'exr']) $(ending).href = `view.${ending}?${query()}`;
}
const filmButtons = ['gif', 'webp', 'mp4'].map($);

// A film of focus goes over the slider, but not beyond the panel; one of parallax from left to right, for which it gets an eye.
async function takeFilm(ending) {
  for (const button of filmButtons) button.disabled = true;
  const kind = $('film-of').value, { from, to, values } = playRange(kind);
  if (Object.keys(values).length > 0) change(values);
  const asked = query({ sweep: kind, 'sweep-from': `${Math.max(kind === 'focus' ? 0 : -Infinity, from)} mm`, 'sweep-to': `${to} mm` });
  $('film-text').textContent = `Making the film ${kind}.${ending} …`;
  try {
    const film = URL.createObjectURL(new Blob([await api.bytes(`film.${ending}?${asked}`)]));
    element('a', '', { href: film, download: `${kind}.${ending}` }).click();
    setTimeout(() => URL.revokeObjectURL(film), 60000);
    $('film-text').textContent = `The film ${kind}.${ending} is among your downloads.`;
  } catch (error) {
    $('film-text').textContent = error.message;
  }
  for (const button of filmButtons) button.disabled = false;
}
for (const ending of ['gif', 'webp', 'mp4']) $(ending).addEventListener('click', () => takeFilm(ending));
$('copy').addEventListener('click', async () => {
  await navigator.clipboard?.writeText($('command').textContent).then(() => { $('status').textContent = 'copied'; }, () => {});
});
