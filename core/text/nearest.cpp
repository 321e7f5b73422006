#include "core/text/nearest.h"

#include <algorithm>
#include <cctype>
#include <vector>

namespace luxrig {
namespace {

constexpr std::size_t kLongestCompared = 100;  // longer text is not a slip of the finger

char folded(char c) { return c == '-' ? '_' : static_cast<char>(std::tolower(static_cast<unsigned char>(c))); }

/// Optimal string alignment distance.
std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool same = folded(a[i - 1]) == folded(b[j - 1]);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (same ? 0 : 1)});
      if (i > 1 && j > 1 && folded(a[i - 1]) == folded(b[j - 2]) && folded(a[i - 2]) == folded(b[j - 1])) {
        row[j] = std::min(row[j], before[j - 2] + 1);
      }
    }
    std::swap(before, last);
    std::swap(last, row);
  }
  return last[b.size()];
}

}  // namespace

std::string_view nearest_name(std::string_view wanted, std::span<const std::string_view> known) {
  std::string_view best;
  if (wanted.size() > kLongestCompared) return best;
  // An omitted unit: "beam_angle" for "beam_angle_deg".
  for (const std::string_view name : known) {
    if (!wanted.empty() && name.size() > wanted.size() && name.starts_with(wanted) && name[wanted.size()] == '_') {
      return name;
    }
  }
  std::size_t best_distance = std::max<std::size_t>(2, wanted.size() / 3) + 1;
  for (const std::string_view name : known) {
    const std::size_t longer = std::max(name.size(), wanted.size()), shorter = std::min(name.size(), wanted.size());
    if (name.size() > kLongestCompared || longer - shorter >= best_distance) continue;
    const std::size_t d = distance(wanted, name);
    if (d < best_distance && d < longer) {
      best_distance = d;
      best = name;
    }
  }
  return best;
}

std::string mend_for_unknown(std::string_view wanted, std::span<const std::string_view> known,
                             std::string_view otherwise) {
  if (known.empty()) return std::string(otherwise);
  if (const std::string_view near = nearest_name(wanted, known); !near.empty()) {
    return "did you mean \"" + std::string(near) + "\"?";
  }
  constexpr std::size_t kListed = 12;
  std::string list;
  for (std::size_t i = 0; i < std::min(known.size(), kListed); ++i) {
    list += (i > 0 ? ", " : "") + std::string(known[i]);
  }
  if (known.size() > kListed) list += " and " + std::to_string(known.size() - kListed) + " more";
  return "known: " + list;
}

}  // namespace luxrig
