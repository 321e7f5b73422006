// Any bytes as an STL file: refused with a remedy, or a Scene that keeps its promises; never a crash.
#include "mesh_from_bytes.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const luxrig::MeshFromBytes mesh("stl");
  mesh.check(data, size);
  return 0;
}
