#pragma once
/// JSON Schemas (2020-12) of what the daemon takes and answers, made of few parts.

#include <initializer_list>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace luxrig::schema {

using Schema = nlohmann::ordered_json;

/// The same with a description.
[[nodiscard]] Schema said(Schema schema, const char* what);

[[nodiscard]] Schema text(const char* what = "");
/// One of these strings.
[[nodiscard]] Schema one_of_texts(std::initializer_list<const char*> texts);
[[nodiscard]] Schema yes_or_no(const char* what = "");
/// True, and nothing else.
[[nodiscard]] Schema yes();
[[nodiscard]] Schema number(const char* what = "");
[[nodiscard]] Schema at_least(double least, const char* what = "");
[[nodiscard]] Schema between(double least, double most, const char* what = "");
/// Above 0, and at most this.
[[nodiscard]] Schema up_to(double most, const char* what = "");
[[nodiscard]] Schema count(double least = 0, double most = std::numeric_limits<double>::infinity(),
                           const char* what = "");
[[nodiscard]] Schema list(Schema items, std::size_t least = 0);
/// [x, y, z], or as many numbers as it says.
[[nodiscard]] Schema vector(const char* what = "", std::size_t length = 3);
/// Or null.
[[nodiscard]] Schema or_null(Schema schema);
[[nodiscard]] Schema any_of(std::initializer_list<Schema> schemas);
/// A schema of this name in the file's components.
[[nodiscard]] Schema ref(const std::string& component);

struct Key {
  const char* name;
  Schema of;
  bool needed = true;
};
[[nodiscard]] Key maybe(const char* name, Schema of);
/// A key that must be absent.
[[nodiscard]] Key never(const char* name);

[[nodiscard]] std::vector<Key> both(std::vector<Key> some, const std::vector<Key>& more);

/// With these keys and no others: an answer.
[[nodiscard]] Schema answer(const std::vector<Key>& keys);
/// With these keys; others are not read: a request.
[[nodiscard]] Schema request(const std::vector<Key>& keys);

}  // namespace luxrig::schema
