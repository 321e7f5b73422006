#pragma once
/// Modbus registers of a product, its limits on the line, and its behaviour when data stops.

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/rig/brief.h"
#include "core/rig/patch.h"
#include "core/time.h"

namespace luxrig {

enum class RegisterRole { other, level, illuminance, temperature, status, setting, failure };
/// The four tables of a unit, each with its own addresses.
enum class RegisterTable {
  holding,  ///< functions 3, 6, 16
  input,    ///< function 4
  coil,     ///< one bit: functions 1, 5, 15
  discrete  ///< one bit: function 2
};
[[nodiscard]] constexpr bool is_bit(RegisterTable table) {
  return table == RegisterTable::coil || table == RegisterTable::discrete;
}
[[nodiscard]] const char* name_of(RegisterTable table);
enum class RegisterAccess { read_write, read_only, write_only };

/// One number of the product. `count` in the file makes several of them.
struct MappedRegister {
  std::string name;
  RegisterRole role = RegisterRole::other;
  int address = 0;  ///< 0-based, of the first of format.registers
  RegisterTable table = RegisterTable::holding;
  RegisterFormat format;
  double scale = 1;  ///< of one count, in `unit`
  std::string unit;
  RegisterAccess access = RegisterAccess::read_write;
  std::optional<std::pair<double, double>> range_raw;  ///< always set for a level: dark, full
  int power_on_raw = 0;
  int of_several = 0;  ///< with `count` in the file: 1, 2 …; 0 = single
  FilePosition in_file;  ///< in the map file
};

enum class DataLoss { hold, dark, watchdog };

struct SetupWrite {
  std::size_t index = 0;  ///< of RegisterMap::registers
  int value_raw = 0;
};

struct RegisterMap {
  std::string name;    ///< maker and product
  std::string source;  ///< public document
  std::vector<std::string> assumed;
  std::optional<Duration> answer_time;  ///< longest
  Duration shortest_gap{};              ///< between two requests to it
  int largest_read = 125, largest_write = 123;
  std::vector<int> baud_rates;  ///< empty: any
  DataLoss when_data_stops = DataLoss::hold;
  std::optional<Duration> stops_after;  ///< with dark and watchdog
  std::vector<MappedRegister> registers;
  std::vector<SetupWrite> setup;

  /// Whether a failure bit (role failure) concerns this level. A bit of a series concerns the level of the same number
  /// if levels are a series, too. Any other concerns all levels.
  [[nodiscard]] bool concerns(std::size_t failure, std::size_t level) const;
  /// Registers of one role, in the order of the file.
  [[nodiscard]] std::vector<std::size_t> with_role(RegisterRole role) const;
  [[nodiscard]] std::optional<std::size_t> find(std::string_view register_name) const;
};

/// "holds its last level for ever", "goes dark after 2 s by its watchdog, which is armed".
[[nodiscard]] std::string told_when_data_stops(const RegisterMap& map);

}  // namespace luxrig
