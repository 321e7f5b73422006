#pragma once
/// What a product keeps in its Modbus registers, its limits on the line, and what it does when data stops.

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/rig/rig.h"
#include "core/time.h"

namespace luxrig {

enum class RegisterRole { other, level, illuminance, temperature, status, setting };
enum class RegisterAccess { read_write, read_only, write_only };

/// One number of the product; with `count` in the file, one for each.
struct MappedRegister {
  std::string name;
  RegisterRole role = RegisterRole::other;
  int address = 0;     ///< 0-based, of the first of format.registers
  bool input = false;  ///< input register (function 4), else holding (function 3)
  RegisterFormat format;
  double scale = 1;  ///< of one count, in `unit`
  std::string unit;
  RegisterAccess access = RegisterAccess::read_write;
  std::optional<std::pair<double, double>> range_raw;  ///< always there for a level: dark, full
  int power_on_raw = 0;
  Place place;  ///< in the map file
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

  /// Those of one role, in the order of the file.
  [[nodiscard]] std::vector<std::size_t> with_role(RegisterRole role) const;
  [[nodiscard]] std::optional<std::size_t> find(std::string_view register_name) const;
};

/// "holds its last level for ever", "goes dark after 2 s by its watchdog, which is armed".
[[nodiscard]] std::string told_when_data_stops(const RegisterMap& map);

}  // namespace luxrig
