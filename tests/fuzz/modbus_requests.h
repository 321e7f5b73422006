#pragma once
/// For fuzz targets: one request of each function; the answer is any bytes.

#include <cstdint>

#include "drivers/modbus/modbus_codec.h"

namespace luxrig::fuzz {

inline modbus::Request request_for(std::uint8_t choice) {
  using modbus::Function;
  switch (choice % 8) {
    case 0:
      return {1, Function::read_holding, 2, 2, {}};
    case 1:
      return {17, Function::read_input, 0, 125, {}};
    case 2:
      return {1, Function::write_single, 0, 1, {255}};
    case 3:
      return {1, Function::write_multiple, 10, 0, {128, 512}};
    case 4:
      return {1, Function::read_coils, 19, 19, {}};
    case 5:
      return {17, Function::read_discrete, 0, 2000, {}};
    case 6:
      return {1, Function::write_coil, 172, 0, {1}};
    default:
      return {1, Function::write_coils, 19, 0, {1, 0, 1, 1, 0, 0, 1, 1, 1, 0}};
  }
}

}  // namespace luxrig::fuzz
