#include "core/rig/personality/ofl/ofl_pixels.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

namespace luxrig {
namespace {

/// Compares numbers within a text by value: "M2" comes before "M10".
bool comes_before(const std::string& a, const std::string& b) {
  const auto digit = [](char letter) { return std::isdigit(static_cast<unsigned char>(letter)) != 0; };
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (digit(a[i]) && digit(b[j])) {
      const auto run = [&](const std::string& text, std::size_t& at) {
        while (at + 1 < text.size() && text[at] == '0' && digit(text[at + 1])) ++at;
        const std::size_t begin = at;
        while (at < text.size() && digit(text[at])) ++at;
        return text.substr(begin, at - begin);
      };
      const std::string x = run(a, i), y = run(b, j);
      if (x.size() != y.size()) return x.size() < y.size();
      if (x != y) return x < y;
    } else {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i, ++j;
    }
  }
  return a.size() - i < b.size() - j;
}

void read_counted(const OflJson& count, OflMatrix& out) {
  std::array<int, 3> size{};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto number = ofl_entity(count[i], "");
    if (!number || !(*number >= 1)) return;
    if (*number > static_cast<double>(kMaxPixels)) {
      out.too_large = true;
      return;
    }
    size[i] = static_cast<int>(*number);
  }
  if (static_cast<std::size_t>(size[0]) * size[1] * size[2] > kMaxPixels) {
    out.too_large = true;
    return;
  }
  const int axes = (size[0] > 1) + (size[1] > 1) + (size[2] > 1);
  for (int z = 1; z <= size[2]; ++z)
    for (int y = 1; y <= size[1]; ++y)
      for (int x = 1; x <= size[0]; ++x) {
        // One axis: 1, 2, …; two: those two; three: all.
        std::string key;
        for (const auto& [at, along] : {std::pair{x, size[0]}, std::pair{y, size[1]}, std::pair{z, size[2]}}) {
          if (axes < 3 && along == 1) continue;
          key += fmt::format("{}{}", key.empty() ? "" : ", ", at);
        }
        if (key.empty()) key = "1";
        out.pixels.push_back({axes <= 1 ? key : "(" + key + ")", x, y, z});
      }
}

void read_keyed(const OflJson& layers, OflMatrix& out) {
  for (std::size_t z = 0; z < layers.size(); ++z) {
    if (!layers[z].is_array()) continue;
    for (std::size_t y = 0; y < layers[z].size(); ++y) {
      if (!layers[z][y].is_array()) continue;
      for (std::size_t x = 0; x < layers[z][y].size(); ++x) {
        const std::string key = ofl_text(layers[z][y][x]);
        if (key.empty() || out.has(key)) continue;  // one pixel may fill several cells
        if (out.pixels.size() == kMaxPixels) {
          out.too_large = true;
          return;
        }
        out.pixels.push_back({key, static_cast<int>(x), static_cast<int>(y), static_cast<int>(z)});
      }
    }
  }
}

}  // namespace

bool OflMatrix::has(std::string_view key) const {
  return std::any_of(pixels.begin(), pixels.end(), [&](const Pixel& pixel) { return pixel.key == key; }) ||
         std::find(groups.begin(), groups.end(), key) != groups.end();
}

std::vector<std::string> OflMatrix::order(std::string_view repeat_for) const {
  constexpr std::string_view kEach = "eachPixel";
  if (repeat_for == "eachPixelGroup") return groups;
  if (!repeat_for.starts_with(kEach) || repeat_for.size() != kEach.size() + 3) return {};
  std::vector<Pixel> sorted = pixels;
  const std::string_view axes = repeat_for.substr(kEach.size());
  if (axes == "ABC") {
    std::sort(sorted.begin(), sorted.end(), [](const Pixel& a, const Pixel& b) { return comes_before(a.key, b.key); });
  } else {
    const auto along = [](const Pixel& pixel, char axis) {
      return axis == 'X' ? pixel.x : axis == 'Y' ? pixel.y : pixel.z;
    };
    std::stable_sort(sorted.begin(), sorted.end(), [&](const Pixel& a, const Pixel& b) {
      for (const std::size_t i : {2, 1, 0})  // the first axis named runs fastest
        if (along(a, axes[i]) != along(b, axes[i])) return along(a, axes[i]) < along(b, axes[i]);
      return false;
    });
  }
  std::vector<std::string> keys;
  for (const Pixel& pixel : sorted) keys.push_back(pixel.key);
  return keys;
}

OflMatrix read_ofl_matrix(const OflJson& matrix) {
  OflMatrix out;
  if (const OflJson& count = ofl_member(matrix, "pixelCount"); count.is_array() && count.size() == 3)
    read_counted(count, out);
  if (const OflJson& keys = ofl_member(matrix, "pixelKeys"); keys.is_array()) read_keyed(keys, out);
  if (const OflJson& groups = ofl_member(matrix, "pixelGroups"); groups.is_object()) {
    for (const auto& [name, members] : groups.items()) {
      if (out.groups.size() == kMaxPixels) {
        out.too_large = true;
        break;
      }
      out.groups.push_back(name);
      if (members.is_string() && members == "all") out.whole.push_back(name);
    }
  }
  return out;
}

}  // namespace luxrig
