// The values of a live scene. Each may be changed; places of objects and lamps may be dragged in the view.

import { change, onChange, session, state } from './state.js';

const $ = id => document.getElementById(id);
const place = /^\s*([-+\d.eE]+)\s+([-+\d.eE]+)\s+([-+\d.eE]+)\s*(nm|um|µm|mm|cm|m)\s*$/;
const millimetres = { nm: 1e-6, um: 1e-3, µm: 1e-3, mm: 1, cm: 10, m: 1000 };
const shortest = value => Number(value.toPrecision(7));

function element(name, text = '', attributes = {}) {
  const made = document.createElement(name);
  made.textContent = text;
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  return made;
}

const textOf = value => state.edits[value.key] ?? value.value;

function edit(value, text) {
  const edits = { ...state.edits };
  if (text === '' || text === value.value) delete edits[value.key]; else edits[value.key] = text;
  change({ edits });
}

// Only of the scene's own objects and lamps is it known how places lie to the panel: parts of shapes turn and scale with them.
const isMovable = value => /^(object|light)\.\d+\.[a-z_]+$/.test(value.key) && place.test(value.value);

/** The place that is dragged in the view: where it is [mm], and how it gets there; null if none is. */
export function heldPlace() {
  const value = session.live?.find(one => one.key === state.held), found = value && place.exec(textOf(value));
  if (!found) return null;
  const unit = millimetres[found[4]];
  return {
    at: found.slice(1, 4).map(number => Number(number) * unit),
    move(to) { edit(value, `${to.map(v => shortest(v / unit)).join(' ')} ${found[4]}`); },
  };
}

// Input fields of a value, and the text that they say.
function fieldsOf(value) {
  const found = place.exec(value.value), box = element('span', '', { class: 'value' }), name = value.key;
  const add = (attributes, text) => {
    const input = element('input', '', attributes);
    input.value = text;
    input.addEventListener('input', () => edit(value, read()));
    box.append(input);
    return input;
  };
  const inputs = [];
  const read = () => (found ? `${inputs.map(input => input.value || '0').join(' ')} ${found[4]}` : inputs[0].value.trim());
  const write = text => {
    const parts = found ? place.exec(text)?.slice(1, 4) ?? [] : [text];
    inputs.forEach((input, i) => { if (document.activeElement !== input && parts[i] !== undefined) input.value = parts[i]; });
  };
  if (found) {
    const step = shortest(1 / millimetres[found[4]] / 2);
    for (const [i, axis] of ['x', 'y', 'z'].entries())
      inputs.push(add({ type: 'number', step, 'aria-label': `${name}, ${axis}` }, found[i + 1]));
    box.append(element('span', found[4]));
  } else if (value.value !== '' && Number.isFinite(Number(value.value))) {
    const number = Math.abs(Number(value.value));
    inputs.push(add({ type: 'number', step: shortest(number > 0 ? number / 20 : 0.1), 'aria-label': name }, value.value));
  } else {
    inputs.push(add({ type: 'text', 'aria-label': name, spellcheck: 'false' }, value.value));
  }
  listeners.push(values => { if ('edits' in values) write(textOf(value)); });
  return box;
}

function rowOf(value) {
  const row = element('div', '', { class: 'edit' }), name = value.key.slice(value.key.lastIndexOf('.') + 1);
  row.append(element('span', name.replaceAll('_', ' ')), fieldsOf(value));
  if (isMovable(value)) {
    const button = element('button', 'Drag', { type: 'button', 'aria-pressed': 'false', title: 'Dragging in the view moves it' });
    button.addEventListener('click', () => change({ held: state.held === value.key ? '' : value.key }));
    listeners.push(values => { if ('held' in values) button.setAttribute('aria-pressed', String(state.held === value.key)); });
    row.append(button);
  }
  return row;
}

// Of the list as it is now.
let listeners = [];
onChange(values => { for (const work of listeners) work(values); });

/** Makes the list of values, one group for each table of the scene. Edits of values that the scene has no longer are dropped. */
export function buildLive() {
  listeners = [];
  $('live-section').hidden = !session.live;
  if (!session.live) return;
  const known = Object.entries(state.edits).filter(([key]) => session.live.some(value => value.key === key));
  state.edits = Object.fromEntries(known);
  const groups = new Map();
  for (const value of session.live) {
    const end = value.key.lastIndexOf('.'), table = end < 0 ? 'scene' : value.key.slice(0, end);
    if (!groups.has(table)) groups.set(table, []);
    groups.get(table).push(value);
  }
  $('live').replaceChildren(...[...groups].map(([table, values]) => {
    const group = element('details'), title = table.replaceAll('.', ' ');
    const kind = values[0].of && !title.includes(values[0].of) ? ` · ${values[0].of}` : '';
    group.open = /^(scene|rotation|object|light)\b/.test(table) && session.live.length < 60;
    group.append(element('summary', title + kind), ...values.map(rowOf));
    return group;
  }));
  const movable = session.live.find(isMovable);
  if (!state.held && movable) change({ held: movable.key });
}

$('live-reset').addEventListener('click', () => change({ edits: {} }));
