#include "tools/luxrigd/api/schema.h"

#include <cmath>

namespace luxrig::schema {
namespace {

Schema of_type(const char* type, const char* what) { return said({{"type", type}}, what); }

/// Whole numbers without a point.
Schema plain(double value) {
  if (value == std::floor(value) && std::abs(value) < 1e15) return static_cast<std::int64_t>(value);
  return value;
}

Schema object(const std::vector<Key>& keys, bool closed) {
  Schema out = {{"type", "object"}};
  Schema needed = Schema::array(), properties = Schema::object();
  for (const Key& key : keys) {
    properties[key.name] = key.of;
    if (key.needed) needed.push_back(key.name);
  }
  if (!needed.empty()) out["required"] = std::move(needed);
  out["properties"] = std::move(properties);
  if (closed) out["additionalProperties"] = false;
  return out;
}

}  // namespace

Schema said(Schema schema, const char* what) {
  if (*what != '\0') schema["description"] = what;
  return schema;
}

Schema text(const char* what) { return of_type("string", what); }

Schema one_of_texts(std::initializer_list<const char*> texts) {
  Schema out = {{"enum", Schema::array()}};
  for (const char* one : texts) out["enum"].push_back(one);
  return out;
}

Schema yes_or_no(const char* what) { return of_type("boolean", what); }
Schema yes() { return {{"const", true}}; }
Schema number(const char* what) { return of_type("number", what); }

Schema at_least(double least, const char* what) {
  Schema out = of_type("number", what);
  out["minimum"] = plain(least);
  return out;
}

Schema between(double least, double most, const char* what) {
  Schema out = at_least(least, what);
  out["maximum"] = plain(most);
  return out;
}

Schema up_to(double most, const char* what) {
  Schema out = of_type("number", what);
  out["exclusiveMinimum"] = 0;
  out["maximum"] = plain(most);
  return out;
}

Schema count(double least, double most, const char* what) {
  Schema out = of_type("integer", what);
  out["minimum"] = plain(least);
  if (std::isfinite(most)) out["maximum"] = plain(most);
  return out;
}

Schema list(Schema items, std::size_t least) {
  Schema out = {{"type", "array"}, {"items", std::move(items)}};
  if (least > 0) out["minItems"] = least;
  return out;
}

Schema vector(const char* what, std::size_t length) {
  Schema out = list(number(), length);
  out["maxItems"] = length;
  return said(std::move(out), what);
}

Schema any_of(std::initializer_list<Schema> schemas) {
  Schema out = {{"anyOf", Schema::array()}};
  for (const Schema& one : schemas) out["anyOf"].push_back(one);
  return out;
}

Schema or_null(Schema schema) { return any_of({std::move(schema), {{"type", "null"}}}); }

Schema ref(const std::string& component) { return {{"$ref", "#/components/schemas/" + component}}; }

Key maybe(const char* name, Schema of) { return {name, std::move(of), false}; }
Key never(const char* name) { return {name, false, false}; }

std::vector<Key> both(std::vector<Key> some, const std::vector<Key>& more) {
  some.insert(some.end(), more.begin(), more.end());
  return some;
}

Schema answer(const std::vector<Key>& keys) { return object(keys, true); }
Schema request(const std::vector<Key>& keys) { return object(keys, false); }

}  // namespace luxrig::schema
