#include "tools/http/json_body.h"

#include <algorithm>

namespace luxrig {
namespace {

constexpr int kMaxDepth = 16;

/// Open brackets at once, outside strings; approximate for text that is not JSON.
int depth_of(const std::string& text) {
  int depth = 0, deepest = 0;
  bool in_text = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_text && c == '\\') {
      ++i;
    } else if (c == '"') {
      in_text = !in_text;
    } else if (!in_text && (c == '[' || c == '{')) {
      deepest = std::max(deepest, ++depth);
    } else if (!in_text && (c == ']' || c == '}')) {
      --depth;
    }
  }
  return deepest;
}

}  // namespace

nlohmann::json json_body(const std::string& body) {
  if (depth_of(body) > kMaxDepth) return nlohmann::json(nlohmann::json::value_t::discarded);
  return nlohmann::json::parse(body, nullptr, false);
}

}  // namespace luxrig
