// Any bytes as a .3ds file, as in MVR: refused with a remedy, or a Scene that keeps its promises; never a crash.
#include "mesh_from_bytes.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const luxrig::MeshFromBytes mesh("3ds");
  mesh.check(data, size);
  return 0;
}
