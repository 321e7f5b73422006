// Any bytes as a glTF, binary or JSON, without other files: refused with a remedy, or a Scene that keeps its promises.
#include "mesh_from_bytes.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const luxrig::MeshFromBytes mesh("glb");
  mesh.check(data, size);
  return 0;
}
