#pragma once

#include <cstdint>
#include <vector>

namespace luxrig::sim {

/// E1.31 data packet: universe 1, one slot. The fields are explained in sacn/sacn_receiver_test.cpp.
inline std::vector<std::uint8_t> sacn_one_slot(std::uint8_t sequence, std::uint8_t level) {
  std::vector<std::uint8_t> packet = {0x00, 0x10, 0x00, 0x00, 'A', 'S', 'C', '-', 'E',  '1',  '.', '1', '7', 0, 0,
                                      0,    0x70, 0x6f, 0,    0,   0,   4,   1,   2,    3,    4,   5,   6,   7, 8,
                                      9,    10,   11,   12,   13,  14,  15,  16,  0x70, 0x59, 0,   0,   0,   2};
  packet.resize(108, 0);
  for (const std::uint8_t byte : std::initializer_list<std::uint8_t>{100, 0, 0, sequence, 0, 0, 1, 0x70, 0x0c, 2, 0xa1,
                                                                     0, 0, 0, 1, 0, 2, 0, level})
    packet.push_back(byte);
  return packet;
}

}  // namespace luxrig::sim
