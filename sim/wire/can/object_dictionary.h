#pragma once
/// The objects of a simulated drive (CiA 301, CiA 402-2) with sizes, access rights and written values. Measured values
/// are queried on each read. Values are unsigned; signed ones in two's complement.

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
  /// `measured`: returns the present value of a measured object.
  explicit ObjectDictionary(std::function<std::uint32_t(const ObjectKey&)> measured);

  [[nodiscard]] const DictionaryObject* find(const ObjectKey& key) const;
  [[nodiscard]] bool has_index(int index) const;
  /// requires an object with that key.
  [[nodiscard]] std::uint32_t value(const ObjectKey& key) const;
  /// Returns an abort code if it refuses. PDO parameters are checked as in CiA 301.
  [[nodiscard]] std::optional<std::uint32_t> write(const ObjectKey& key, std::uint32_t value, int bytes,
                                                   bool pre_operational);
  /// Makes PDOs refuse profile speed and accelerations with that abort code: at the entry if the code means not
  /// mappable or out of range, else at the number of entries. Empty = they can be mapped.
  void refuse_limits_in_pdos(std::optional<std::uint32_t> abort_code) { limits_refused_ = abort_code; }
  /// Write by a PDO or the node itself: no access check. Unknown keys are ignored.
  void put(const ObjectKey& key, std::uint32_t value);

 private:
  [[nodiscard]] std::optional<std::uint32_t> check_pdo(const ObjectKey& key, std::uint32_t value,
                                                       bool pre_operational) const;

  std::map<ObjectKey, DictionaryObject> objects_;
  std::optional<std::uint32_t> limits_refused_;
  std::function<std::uint32_t(const ObjectKey&)> measured_;
};

}  // namespace luxrig::sim
