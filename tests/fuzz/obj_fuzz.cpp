// Any bytes as an OBJ file (without its .mtl): refused with a remedy, or a Scene that keeps its promises; never a crash.
#include "mesh_from_bytes.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const luxrig::MeshFromBytes mesh("obj");
  mesh.check(data, size);
  return 0;
}
