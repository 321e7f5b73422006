#include "core/rig/reading/document.h"

#include <algorithm>

#include "core/text/plain_text.h"

// toml++ 3.3 asserts, and in release builds assumes, that a table header begins like a key; "[*" does not (found by
// fuzzing). Without its assertions it goes on to report the error. It turns them into assumptions, which would be
// undefined behaviour, only under NDEBUG.
#undef NDEBUG
#define TOML_ASSERT(condition) static_cast<void>(0)
#define TOML_HEADER_ONLY 1
#define TOML_EXCEPTIONS 0
#define TOML_ENABLE_FORMATTERS 0
#define TOML_MAX_NESTED_VALUES 32
#include <toml++/toml.h>

namespace luxrig {
namespace {

constexpr int kMaxDottedParts = 16;

struct ParseRefusal {
  FilePosition in_file;
  std::string what, mend;
};

/// Refuses texts that toml++ 3.3 must not see, outside strings and comments:
///   - dotted keys of very many parts: toml++ limits the nesting of [ and {, but not that of a.b.c.d…, and destroys its
///     tables by recursion;
///   - letters outside ASCII, which TOML does not allow there: its test for other white space reaches code that it
///     declares unreachable (found by fuzzing). The same in a string after a backslash and blanks, where it looks for
///     the end of the line (found by fuzzing);
///   - quotes within a word, which it does not see as the start of a string (found by fuzzing).
/// Must agree with toml++ up to the first error of toml++; after that, toml++ reads nothing.
std::optional<ParseRefusal> look_ahead(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  FilePosition here{1, 1};
  int dots = 0;
  std::size_t i = 0;
  const auto at = [&](std::string_view token) { return text.substr(i, token.size()) == token; };
  const auto step = [&] {
    if (text[i] == '\n') {
      ++here.line;
      here.column = 0;
    }
    if ((static_cast<unsigned char>(text[i]) & 0xC0) != 0x80) ++here.column;
    ++i;
  };
  const auto skip_string = [&](char quote) -> bool {  // false = `here` is a letter after a backslash
    const std::string triple(3, quote);
    const bool multi_line = at(triple);
    for (int k = multi_line ? 3 : 1; k > 0; --k) step();
    while (i < text.size()) {
      if (quote == '"' && text[i] == '\\') {
        step();
        const bool blank = i < text.size() && std::string_view(" \t\r\n").find(text[i]) != std::string_view::npos;
        while (blank && i < text.size() && std::string_view(" \t\r\n").find(text[i]) != std::string_view::npos) step();
        if (i < text.size() && static_cast<unsigned char>(text[i]) >= 0x80) return false;
        if (!blank && i < text.size()) step();
      } else if (multi_line && at(triple)) {
        // Up to two quotes may precede the closing three.
        for (int k = 0; k < 5 && i < text.size() && text[i] == quote; ++k) step();
        return true;
      } else if (!multi_line && (text[i] == quote || text[i] == '\n')) {
        if (text[i] == quote) step();
        return true;
      } else {
        step();
      }
    }
    return true;
  };
  // Once a word has begun, toml++ takes everything up to a blank, comma or closing bracket as part of it, even quotes,
  // = and [. So the meaning of a character depends on whether a key or a value is due.
  std::string open;  // brackets of lists and tables within values
  bool value = false, word = false;
  while (i < text.size()) {
    const char c = text[i];
    switch (c) {
      case '"':
      case '\'':
        if (word) {
          return ParseRefusal{here, "not TOML: a quote right after a word or a text", "put a space, = or , in between"};
        }
        if (!skip_string(c)) {
          return ParseRefusal{here, "a letter outside ASCII right after a backslash",
                              "let a text not begin again with such a letter after a backslash at the end of a line"};
        }
        word = true;
        continue;
      case '#':
        while (i < text.size() && text[i] != '\n') step();
        continue;
      case '.':
        if (++dots >= kMaxDottedParts) {
          return ParseRefusal{here, "a key of more than " + std::to_string(kMaxDottedParts) + " dotted parts",
                              "no key of a rig file needs more than three"};
        }
        word = true;
        break;
      case '\n':
        dots = 0;
        word = false;
        if (open.empty()) value = false;
        break;
      case ' ':
      case '\t':
      case '\r':
        word = false;
        break;
      case '=':
        dots = 0;
        word = value;
        value = true;
        break;
      case ',':
        dots = 0;
        word = false;
        if (!open.empty()) value = open.back() == '[';
        break;
      case '[':
      case '{':
        dots = 0;
        if (value && !word) {
          open += c;
          value = c == '[';
        }
        break;
      case ']':
      case '}':
        dots = 0;
        if (!open.empty()) {
          open.pop_back();
          value = word = true;
        }
        break;
      default:
        if (static_cast<unsigned char>(c) >= 0x80) {
          return ParseRefusal{here, "not TOML: a letter outside ASCII that stands in no text",
                              "put the text in quotes"};
        }
        word = true;
    }
    step();
  }
  return std::nullopt;
}

FilePosition place_of(const toml::source_region& region, const FilePosition& otherwise) {
  if (region.begin.line == 0) return otherwise;  // a table implied only by its children
  return {static_cast<int>(region.begin.line), static_cast<int>(region.begin.column)};
}

NodeTable plain_table(const toml::table& table, const FilePosition& parent);

Node plain(const toml::node& node, const FilePosition& parent) {
  Node out;
  out.in_file = place_of(node.source(), parent);
  if (const auto* table = node.as_table()) {
    out.value = plain_table(*table, out.in_file);
  } else if (const auto* list = node.as_array()) {
    NodeList items;
    items.reserve(list->size());
    for (const toml::node& item : *list) items.push_back(plain(item, out.in_file));
    out.value = std::move(items);
  } else if (const auto* text = node.as_string()) {
    out.value = text->get();
  } else if (const auto* integer = node.as_integer()) {
    out.value = integer->get();
  } else if (const auto* number = node.as_floating_point()) {
    out.value = number->get();
  } else if (const auto* boolean = node.as_boolean()) {
    out.value = boolean->get();
  } else {
    out.value = DateOrTime{};
  }
  return out;
}

NodeTable plain_table(const toml::table& table, const FilePosition& parent) {
  NodeTable out;  // sorted, as in toml++
  out.reserve(table.size());
  for (const auto& [key, node] : table) {
    const FilePosition key_place = place_of(key.source(), parent);
    out.push_back({std::string(key.str()), key_place, plain(node, key_place)});
  }
  return out;
}

}  // namespace

const Member* find(const NodeTable& table, std::string_view key) {
  const auto at = std::lower_bound(table.begin(), table.end(), key,
                                   [](const Member& member, std::string_view wanted) { return member.key < wanted; });
  return at != table.end() && at->key == key ? &*at : nullptr;
}

const char* kind_of(const Node& node) {
  static constexpr const char* kKinds[] = {"true or false", "a whole number", "a number",      "text",
                                           "a list",        "a table",        "a date or time"};
  return kKinds[node.value.index()];
}

Checked<NodeTable> parse_document(std::string_view text, const std::string& file_name) {
  const auto refuse = [&](const FilePosition& in_file, std::string what, std::string mend) {
    return tl::unexpected(
        std::vector<Problem>{{file_name, in_file.line, in_file.column, std::move(what), std::move(mend)}});
  };
  if (const auto refusal = look_ahead(text)) return refuse(refusal->in_file, refusal->what, refusal->mend);
  const toml::parse_result result = toml::parse(text, file_name);
  if (!result) {
    const toml::parse_error& error = result.error();
    return refuse(place_of(error.source(), {1, 1}), "not TOML: " + made_plain(error.description()),
                  "one `key = value` a line, text in quotes, tables as [name] or [[name]]; see toml.io");
  }
  return plain_table(result.table(), {1, 1});
}

}  // namespace luxrig
