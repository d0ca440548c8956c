#pragma once

namespace holotrace {

/// The commit that this program was built from, such as "0e3c8875", with "-dirty" if files were changed since; "unknown" if it was
/// built outside of a repository. cmake/commit.cmake writes it in each build.
extern const char* const source_commit;

}  // namespace holotrace
