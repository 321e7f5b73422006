#pragma once
/// Addresses of devices: DMX slots, Modbus registers, drives on a CAN bus, and the buses themselves.

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/geometry.h"
#include "core/rig/scene_spec.h"

namespace luxrig {

/// Function of one DMX slot of a fixture.
enum class SlotUse {
  dimmer,
  dimmer_fine,
  dimmer_ultra,
  pan,
  pan_fine,
  pan_ultra,
  tilt,
  tilt_fine,
  tilt_ultra,
  zoom,
  zoom_fine,
  zoom_ultra,
  constant,
  unused
};

/// The part of a channel's values that is used, as shares of its whole range. For a dimmer, from least to full light.
/// For an angle, from the least to the largest; for a zoom, that is the beam angle.
struct DmxTravel {
  double at_start = 0, at_end = 1;
  double least = 0;                 ///< level at `at_start`: a dimmer may begin at 10 % of its light
  std::optional<double> at_dark{};  ///< value for level 0 and for any below `least`; none = `at_start` is the lowest

  [[nodiscard]] double at(double share) const {
    if (at_dark && (share <= 0 || share < least)) return *at_dark;
    return at_start + (share > least ? (share - least) / (1 - least) : 0) * (at_end - at_start);
  }
};

struct DmxSlot {
  SlotUse use = SlotUse::dimmer;
  int constant_dmx = 0;  ///< 0…255, for SlotUse::constant (an open shutter, say)
  bool sent = true;      ///< false = the fixture obeys the slot, but it is sent for the first fixture of the housing
  int cell = 0;          ///< which channel, if several of one use run together; its slots form one value
  DmxTravel travel{};    ///< of that channel
};

struct DmxPatch {
  int universe = 1;  ///< sACN 1…63999; Art-Net port address 0…32767
  int address = 1;   ///< first slot, 1…512
  std::vector<DmxSlot> slots = {DmxSlot{}};
};

/// Number format of Modbus registers.
enum class RegisterNumber { whole, signed_whole, floating };
struct RegisterFormat {
  int registers = 1;  ///< 1 or 2; floating: 2 (IEEE 754 binary32)
  RegisterNumber number = RegisterNumber::whole;
  bool low_word_first = false;  ///< word order CDAB; only with 2 registers
  bool low_byte_first = false;  ///< bytes of each register swapped: BADC, or DCBA
};

struct RegisterMap;

/// A dimmer channel behind one or two holding registers, or a relay behind a coil.
struct ModbusPatch {
  int unit = 1;               ///< 0…255
  int holding_register = 0;   ///< 0-based, as on the wire
  int full_scale_raw = 1000;  ///< register value at full drive, 1…65535
  int dark_raw = 0;           ///< register value at no drive
  RegisterFormat format{};
  std::shared_ptr<const RegisterMap> map{};  ///< of its product; null = only the register is known
  bool coil = false;                         ///< holding_register is a coil number (functions 5 and 15): on or off
};

using Patch = std::variant<DmxPatch, ModbusPatch>;

/// One joint with its own drive (CiA 402), a node on a CAN bus.
struct AxisPatch {
  int node = 1;  ///< CANopen node id, 1…127
  double counts_per_degree =
      1;                ///< position units of the drive per degree of the joint; not 0; < 0 = counts the other way
  double home_rad = 0;  ///< joint angle at the drive's home position, where it counts 0
  double acceleration_rad_s2 = 0;  ///< > 0, for speeding up and slowing down

  [[nodiscard]] double counts_at(double joint_rad) const {
    return deg_from_rad(joint_rad - home_rad) * counts_per_degree;
  }
  [[nodiscard]] double joint_rad_at(double counts) const { return home_rad + rad_from_deg(counts / counts_per_degree); }
};

/// For a head whose pan and tilt are not on the bus of its lamp.
struct AxesPatch {
  std::size_t bus = 0;
  AxisPatch pan, tilt;
};

/// A driver's own option, as written. Drivers check them (drivers/registry.h).
using OptionValue = std::variant<bool, std::int64_t, double, std::string>;
struct Option {
  OptionValue value;
  FilePosition in_file;
};

struct Bus {
  std::string name;
  std::string driver;                     ///< a name in the driver registry
  std::optional<double> safe_level;       ///< for its fixtures without their own; none = that of [safe]
  std::map<std::string, Option> options;  ///< every further key
  FilePosition in_file;
};

/// How registers become lux.
struct ModbusMeterPatch {
  int unit = 1;
  bool input_registers = false;  ///< function 4; if false, holding registers (function 3)
  int first_register = 0;        ///< 0-based
  int registers = 2;             ///< 1: u16, 2: u32
  bool low_word_first = false;   ///< word order CDAB
  double lux_per_count = 0.001;
  RegisterNumber number = RegisterNumber::whole;
  bool low_byte_first = false;
  std::shared_ptr<const RegisterMap> map{};  ///< of its product; null = only the registers are known

  [[nodiscard]] RegisterFormat format() const { return {registers, number, low_word_first, low_byte_first}; }
};

}  // namespace luxrig
