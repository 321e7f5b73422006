#include "drivers/io/host_id.h"

#include <unistd.h>

#include <array>
#include <fstream>

namespace luxrig {

std::string host_id() {
  std::string id;
  std::ifstream file("/etc/machine-id");
  if (std::getline(file, id) && !id.empty()) return id;
  std::array<char, 256> name{};
  if (::gethostname(name.data(), name.size() - 1) == 0) return name.data();
  return {};
}

}  // namespace luxrig
