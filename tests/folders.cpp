#include "tests/folders.h"

namespace luxrig::test {

std::filesystem::path source_folder() { return LUXRIG_SOURCE_DIR; }
std::filesystem::path program_folder() { return LUXRIG_BIN_DIR; }

}  // namespace luxrig::test
