// Requests to the daemon's HTTP API, made from the schemas of tools/luxrigd/openapi.json: good ones, bad ones, and ones
// that a program which is broken or hostile would send.
import { createRequire } from 'node:module';

const require = createRequire(new URL('../../tools/web/package.json', import.meta.url));
export const fc = require('fast-check');

/** Arbitrary values of JSON Schemas, as far as openapi.json uses them. */
export class Values {
  /** names: known names by the schemas' `format`; real: real bodies by the component's name. */
  constructor(file, names, real) {
    this.file = file;
    this.names = names;
    this.real = real;
  }

  /** A value that the schema allows. */
  of(schema) {
    if (schema.$ref) {
      const name = schema.$ref.split('/').at(-1);
      const made = this.of(this.file.components.schemas[name]);
      return this.real[name] ? fc.oneof(fc.constantFrom(...this.real[name]), made) : made;
    }
    if ('const' in schema) return fc.constant(schema.const);
    if (schema.enum) return fc.constantFrom(...schema.enum);
    if (schema.anyOf) return fc.oneof(...schema.anyOf.map((one) => this.of(one)));
    switch (schema.type) {
      case 'boolean': return fc.boolean();
      case 'integer': return fc.integer({ min: schema.minimum ?? -1e6, max: Math.min(schema.maximum ?? 1e6, 1e6) });
      case 'number': return this.#number(schema);
      case 'string': return this.#text(schema);
      case 'array': return fc.array(this.of(schema.items), { minLength: schema.minItems ?? 0, maxLength: schema.maxItems ?? 4 });
      case 'object': return this.#object(schema);
      default: throw new Error(`no values are known of ${JSON.stringify(schema)}`);
    }
  }

  #number(schema) {
    const min = schema.minimum ?? schema.exclusiveMinimum;
    const any = fc.double({ min, max: schema.maximum, minExcluded: 'exclusiveMinimum' in schema, noNaN: true, noDefaultInfinity: true });
    // The usual ones are small; the ends of a range are where mistakes are.
    const usual = [0, 0.1, 0.5, 1, 2, 10, 60, min, schema.maximum].filter((value) => value !== undefined &&
      value >= (min ?? -1e9) && value <= (schema.maximum ?? 1e9) && value !== schema.exclusiveMinimum);
    return fc.oneof({ weight: 3, arbitrary: fc.constantFrom(...usual) }, any);
  }

  #text(schema) {
    if (schema.pattern) return fc.constantFrom('a-1', 'a-2', 'b_3', 'x'.repeat(40));
    const any = fc.string({ minLength: schema.minLength ?? 0, maxLength: schema.maxLength ?? 20, unit: 'binary' });
    if (schema.format) return fc.oneof({ weight: 7, arbitrary: fc.constantFrom(...this.names[schema.format]) }, any);
    return fc.oneof(fc.constantFrom('hold it here', 'ö', '"', '\\'), any);
  }

  #object(schema) {
    const properties = {};
    for (const [name, of] of Object.entries(schema.properties ?? {})) if (of !== false) properties[name] = this.of(of);
    for (const more of Object.values(schema.dependentSchemas ?? {}))
      for (const [name, of] of Object.entries(more.properties)) properties[name] = this.of(of);
    if (schema.additionalProperties)
      return fc.dictionary(this.of(schema.propertyNames), this.of(schema.additionalProperties), { minKeys: schema.minProperties, maxKeys: 3 });
    if (Object.keys(properties).length === 0) return fc.dictionary(fc.string(), fc.jsonValue());
    return fc.record(properties, { requiredKeys: schema.required ?? [] });
  }

  /** A value that is mostly not allowed: an allowed one that is damaged, or anything. */
  damaged(schema) {
    const rubbish = fc.oneof(fc.jsonValue({ maxDepth: 2 }), fc.constantFrom(null, -1, 1e300, '', [], {}, true, '0.5', [[]], { name: 1 }));
    const broken = fc.tuple(this.of(schema), fc.nat(), rubbish, fc.constantFrom('drop', 'replace', 'add')).map(([value, at, other, how]) => {
      const copy = structuredClone(value);
      if (typeof copy !== 'object' || copy === null) return other;
      const places = [];
      const visit = (node) => {
        for (const key of Object.keys(node)) {
          places.push([node, key]);
          if (typeof node[key] === 'object' && node[key] !== null && places.length < 200) visit(node[key]);
        }
      };
      visit(copy);
      if (places.length === 0) return other;
      const [node, key] = places[at % places.length];
      if (how === 'drop') Array.isArray(node) ? node.splice(Number(key), 1) : delete node[key];
      else if (how === 'replace') node[key] = other;
      else if (Array.isArray(node)) node.push(other);
      else node.more = other;
      return copy;
    });
    return fc.oneof({ weight: 4, arbitrary: broken }, rubbish);
  }
}

/** What is wrong with a request beside its body; the refusal that the daemon owes. */
export const MISDEEDS = {
  stranger: 401,
  'wrong token': 401,
  'other host': 403,
  'other origin': 403,
  'other site': 403,
  'other method': 405,
  'other path': 404,
  'other type': 415,
  'too long': 413,
  'long headers': 431,
};

/** A parameter's value: what an answer before had. */
export const ANSWERED = Symbol('what an answer before had');

/** Values of parameters, in the query or in headers: none, those of an answer before, and rubbish. */
const parametersOf = (parameters) => fc.record(Object.fromEntries((parameters ?? []).map(({ name, in: where }) =>
  [name, where === 'path'
    ? fc.oneof({ weight: 4, arbitrary: fc.constant(ANSWERED) }, fc.constantFrom('00000000-000001', 'x', '%00', '..%2f..%2fstate', '-'.repeat(300)))
    : fc.oneof(fc.constant(undefined), fc.constant(ANSWERED), where === 'header' ? fc.constantFrom('*', '"0"', 'W/"0"', 'x') : fc.string({ unit: 'binary', maxLength: 60 }))])));

/** The path and headers with these parameters. known: values of answers before, by name. */
export function put(operation, parameters, known) {
  const headers = {}, query = new URLSearchParams();
  let path = operation.path;
  for (const { name, in: where } of operation.parameters ?? []) {
    const value = parameters[name] === ANSWERED ? known[name] : parameters[name];
    if (where === 'path') path = path.replace(`{${name}}`, value ?? 'none');
    else if (value !== undefined && where === 'header') headers[name] = value;
    else if (value !== undefined) query.set(name, value);
  }
  return { path: path + (query.size ? `?${query}` : ''), headers };
}

/** One request to one operation: {operation, sent: {body: text or undefined, value}, parameters, misdeed}. */
export function requests(operations, values) {
  const of = ({ schema, operation }) => {
    const bodies = schema
      ? fc.oneof(
        { weight: 6, arbitrary: values.of(schema).map((value) => ({ value, body: JSON.stringify(value) })) },
        { weight: 4, arbitrary: values.damaged(schema).map((value) => ({ value, body: JSON.stringify(value) })) },
        { weight: 1, arbitrary: fc.string({ maxLength: 60 }).map((text) => ({ body: `${text}{` })) },
        { weight: 1, arbitrary: fc.constantFrom('', '[', '{"on":true', '['.repeat(1000), '{"a":'.repeat(30), '\0', '1e999', '{"on":true}{}', '{"fixtures":["\\ud800"],"level":1}').map((body) => ({ body })) })
      : fc.constant({});
    return fc.record({ operation: fc.constant(operation), sent: bodies, parameters: parametersOf(operation.parameters),
      misdeed: fc.oneof({ weight: 9, arbitrary: fc.constant(undefined) }, fc.constantFrom(...Object.keys(MISDEEDS))) });
  };
  return fc.oneof(...operations.map((one) => ({ weight: one.schema ? 3 : 1, arbitrary: of(one) })));
}
