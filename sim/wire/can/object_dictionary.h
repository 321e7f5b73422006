#pragma once
/// The objects of a simulated drive (CiA 301, CiA 402-2) with their sizes and rights, and the values that they were
/// given. What the drive measures is asked of it when it is read. Values are unsigned; signed ones in two's complement.

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>

namespace luxrig::sim {

using ObjectKey = std::pair<int, int>;  ///< index, sub-index

enum class ObjectAccess { constant, measured, written };

struct DictionaryObject {
  int bytes = 4;
  ObjectAccess access = ObjectAccess::written;
  bool mappable = false;
  std::uint32_t value = 0;
};

/// SDO abort codes.
inline constexpr std::uint32_t kNoObject = 0x06020000, kNoSubIndex = 0x06090011, kReadOnlyObject = 0x06010002,
                               kWrongLength = 0x06070010, kOutOfRange = 0x06090030, kNotMappable = 0x06040041,
                               kPdoTooLong = 0x06040042, kNotInThisState = 0x08000022, kUnknownCommand = 0x05040001;

class ObjectDictionary {
 public:
  /// `measured`: what an object of that kind is worth now.
  explicit ObjectDictionary(std::function<std::uint32_t(const ObjectKey&)> measured);

  [[nodiscard]] const DictionaryObject* find(const ObjectKey& key) const;
  [[nodiscard]] bool has_index(int index) const;
  /// requires an object of that key.
  [[nodiscard]] std::uint32_t value(const ObjectKey& key) const;
  /// An abort code when it cannot be written so. PDO parameters are checked as CiA 301 asks.
  [[nodiscard]] std::optional<std::uint32_t> write(const ObjectKey& key, std::uint32_t value, int bytes,
                                                   bool pre_operational);
  /// No PDO carries profile speed and accelerations: with that abort code, of the entry where it says that one cannot
  /// be mapped or is out of range, else of the number of entries. Nothing: they can be mapped.
  void refuse_limits_in_pdos(std::optional<std::uint32_t> abort_code) { limits_refused_ = abort_code; }
  /// As a PDO or the node itself does it: no rights asked. Unknown keys are ignored.
  void put(const ObjectKey& key, std::uint32_t value);

 private:
  [[nodiscard]] std::optional<std::uint32_t> check_pdo(const ObjectKey& key, std::uint32_t value,
                                                       bool pre_operational) const;

  std::map<ObjectKey, DictionaryObject> objects_;
  std::optional<std::uint32_t> limits_refused_;
  std::function<std::uint32_t(const ObjectKey&)> measured_;
};

}  // namespace luxrig::sim
