// Paths of the project's files and programs, for tests.
#pragma once
#include <filesystem>

namespace luxrig::test {

std::filesystem::path source_folder();   // the project's own
std::filesystem::path program_folder();  // of the build that this test belongs to

}  // namespace luxrig::test
