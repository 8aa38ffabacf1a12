// What the entries of figures share.
import {number, unique} from './chart.js';

export const kFailed = ['not_finite', 'diverged', 'device_lost', 'timed_out', 'crashed', 'error'];
export const percent = v => v === null || v === undefined ? '–' : `${number(100 * v, 3)} %`;
export const file_of = name => name.replace(/[^A-Za-z0-9._=-]+/g, '-');

/// The harness without a cloth model is decades faster than every solver. It is drawn only if no other solver is.
export const without_floor = (rows, floor) =>
    rows.every(r => floor.includes(r.solver)) ? rows : rows.filter(r => !floor.includes(r.solver));

export const by_solver = rows => unique(rows.map(r => r.solver)).map(solver => [solver, rows.filter(r => r.solver === solver)]);
