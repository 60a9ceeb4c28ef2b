/// How this program was built.
#pragma once

namespace irt {

extern const char* const build_compiler;  ///< name and version
extern const char* const build_flags;     ///< what decides the generated code; warnings left out
extern const char* const build_type;      ///< CMake's name of it
/// Abbreviated commit, with "-dirty" where tracked files differed; "unknown" outside a repository.
extern const char* const build_commit;

}  // namespace irt
