#include "sim/wire/can/object_dictionary.h"

namespace luxrig::sim {
namespace {

constexpr std::uint32_t kOff = 0x80000000;

bool is_pdo_mapping(int index) { return (index >= 0x1600 && index <= 0x1603) || (index >= 0x1A00 && index <= 0x1A03); }
bool is_limit(std::uint32_t entry) {
  const std::uint32_t index = entry >> 16;
  return index == 0x6081 || index == 0x6083 || index == 0x6084;
}
bool is_pdo_parameter(int index) {
  return (index >= 0x1400 && index <= 0x1403) || (index >= 0x1800 && index <= 0x1803);
}

}  // namespace

ObjectDictionary::ObjectDictionary(std::function<std::uint32_t(const ObjectKey&)> measured)
    : measured_(std::move(measured)) {
  const auto constant = [this](int index, int sub, int bytes, std::uint32_t value) {
    objects_[{index, sub}] = {bytes, ObjectAccess::constant, false, value};
  };
  const auto measure = [this](int index, int bytes) {
    objects_[{index, 0}] = {bytes, ObjectAccess::measured, true, 0};
  };
  const auto variable = [this](int index, int sub, int bytes, std::uint32_t value, bool mappable = false) {
    objects_[{index, sub}] = {bytes, ObjectAccess::written, mappable, value};
  };
  constant(0x1000, 0, 4, 0x00020192);  // servo drive, profile 402
  measure(0x1001, 1);
  constant(0x1008, 0, 4, 0);  // text: the node sends it in segments
  constant(0x1016, 0, 1, 1);
  variable(0x1016, 1, 4, 0);
  variable(0x1017, 0, 2, 0);
  constant(0x1018, 0, 1, 4);
  for (int sub = 1; sub <= 4; ++sub) constant(0x1018, sub, 4, static_cast<std::uint32_t>(sub == 2 ? 0x4C58 : 0));
  constant(0x1029, 0, 1, 1);
  variable(0x1029, 1, 1, 0);
  for (int number = 0; number < 4; ++number) {
    for (const int base : {0x1400, 0x1800}) {
      const int first_id = base == 0x1400 ? 0x200 : 0x180;
      constant(base + number, 0, 1, 5);
      variable(base + number, 1, 4, kOff | static_cast<std::uint32_t>(first_id + 0x100 * number));
      variable(base + number, 2, 1, 255);
      for (int sub = 0; sub <= 8; ++sub) variable(base + 0x200 + number, sub, sub == 0 ? 1 : 4, 0);
    }
  }
  variable(0x6007, 0, 2, 1);
  measure(0x603F, 2);
  variable(0x6040, 0, 2, 0, true);
  measure(0x6041, 2);
  variable(0x605A, 0, 2, 2);
  variable(0x6060, 0, 1, 0, true);
  measure(0x6061, 1);
  measure(0x6064, 4);
  variable(0x6065, 0, 4, 0);
  variable(0x6066, 0, 2, 20);
  measure(0x606C, 4);
  variable(0x607A, 0, 4, 0, true);
  variable(0x607C, 0, 4, 0);
  constant(0x607D, 0, 1, 2);
  variable(0x607D, 1, 4, 0);
  variable(0x607D, 2, 4, 0);
  for (const int index : {0x6081, 0x6083, 0x6084, 0x6085}) variable(index, 0, 4, 1000, index != 0x6085);
  variable(0x6098, 0, 1, 0);
  constant(0x6099, 0, 1, 2);
  variable(0x6099, 1, 4, 1000);
  variable(0x6099, 2, 4, 100);
  variable(0x609A, 0, 4, 1000);
  measure(0x60FD, 4);
  constant(0x6502, 0, 4, 0x21);  // profile position, homing
}

const DictionaryObject* ObjectDictionary::find(const ObjectKey& key) const {
  const auto found = objects_.find(key);
  return found == objects_.end() ? nullptr : &found->second;
}

bool ObjectDictionary::has_index(int index) const {
  const auto found = objects_.lower_bound({index, 0});
  return found != objects_.end() && found->first.first == index;
}

std::uint32_t ObjectDictionary::value(const ObjectKey& key) const {
  const DictionaryObject& object = objects_.at(key);
  return object.access == ObjectAccess::measured ? measured_(key) : object.value;
}

void ObjectDictionary::put(const ObjectKey& key, std::uint32_t value) {
  const auto found = objects_.find(key);
  if (found != objects_.end()) found->second.value = value;
}

std::optional<std::uint32_t> ObjectDictionary::check_pdo(const ObjectKey& key, std::uint32_t value,
                                                         bool pre_operational) const {
  const auto [index, sub] = key;
  const bool mapping = is_pdo_mapping(index);
  if (!mapping && !is_pdo_parameter(index)) return std::nullopt;
  if (!pre_operational) return kNotInThisState;
  if (mapping) {
    if ((objects_.at({index - 0x200, 1}).value & kOff) == 0) return kNotInThisState;  // while it is on
    if (sub == 0) {
      if (value > 8) return kOutOfRange;
      std::uint32_t bits = 0;
      for (int i = 1; i <= static_cast<int>(value); ++i) {
        const std::uint32_t entry = objects_.at({index, i}).value;
        if (entry == 0) return kNotMappable;  // never set
        if (is_limit(entry) && limits_refused_) return limits_refused_;
        bits += entry & 0xFF;
      }
      return bits > 64 ? std::optional(kPdoTooLong) : std::nullopt;
    }
    if (objects_.at({index, 0}).value != 0) return kNotInThisState;
    if (is_limit(value) && limits_refused_ && *limits_refused_ != kPdoTooLong) return limits_refused_;
    const DictionaryObject* mapped = find({static_cast<int>(value >> 16), static_cast<int>(value >> 8 & 0xFF)});
    const bool to_node = index < 0x1A00;
    if (mapped == nullptr || !mapped->mappable || (value & 0xFF) != static_cast<std::uint32_t>(8 * mapped->bytes) ||
        (to_node && mapped->access == ObjectAccess::measured)) {
      return kNotMappable;
    }
  } else if (sub == 1 && (value & ~kOff) > 0x7FF) {
    return kOutOfRange;
  } else if (sub == 2 && value > 240 && value < 254) {
    return kOutOfRange;
  }
  return std::nullopt;
}

std::optional<std::uint32_t> ObjectDictionary::write(const ObjectKey& key, std::uint32_t value, int bytes,
                                                     bool pre_operational) {
  const auto found = objects_.find(key);
  if (found == objects_.end()) return has_index(key.first) ? kNoSubIndex : kNoObject;
  DictionaryObject& object = found->second;
  if (object.access != ObjectAccess::written) return kReadOnlyObject;
  if (bytes != 0 && bytes != object.bytes) return kWrongLength;
  if (object.bytes < 4) value &= (1u << (8 * object.bytes)) - 1;
  if (auto refused = check_pdo(key, value, pre_operational)) return refused;
  if (key.first == 0x6060 && value != 0 && value != 1 && value != 6) return kOutOfRange;
  object.value = value;
  return std::nullopt;
}

}  // namespace luxrig::sim
