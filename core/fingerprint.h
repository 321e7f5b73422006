#pragma once
/// Says whether something is the same as before. No cryptography.

#include <bit>
#include <cstdint>
#include <optional>
#include <string_view>

#include "core/geometry.h"

namespace luxrig {

/// FNV-1a over 64-bit words, each mixed first: no cryptography, only "is it the same".
class Fingerprint {
 public:
  void add(std::uint64_t word) {
    word *= 0x9e3779b97f4a7c15U;
    hash_ = (hash_ ^ word ^ (word >> 32U)) * 0x100000001b3U;
  }
  void add(double value) { add(std::bit_cast<std::uint64_t>(value == 0 ? 0.0 : value)); }
  void add(const std::optional<double>& value) {
    add(std::uint64_t{value.has_value()});
    if (value) add(*value);
  }
  void add(const Vec3& v) {
    for (const double value : {v.x(), v.y(), v.z()}) add(value);
  }
  void add(std::string_view text) {
    add(std::uint64_t{text.size()});
    for (const char c : text) add(static_cast<std::uint64_t>(static_cast<unsigned char>(c)));
  }
  void add(const Pose& pose) {
    add(pose.translation_m);
    for (int column = 0; column < 3; ++column) add(Vec3(pose.rotation.col(column)));
  }
  [[nodiscard]] std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325U;
};

}  // namespace luxrig
