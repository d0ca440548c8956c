#pragma once

#include <string>
#include <vector>

namespace holotrace {

/// Where a scene file has a key of that name, for the message about one below the wrong heading: "below [trace]", "above
/// all headings". Empty if no stage, no panel and no scene has it.
std::vector<std::string> tables_with(const std::string& key);

}  // namespace holotrace
