#include "try_save_chart.h"

#include "console.h"
#include "holotrace/base/error.h"
#include "holotrace/io/picture/chart_file.h"

namespace holotrace {

namespace {

void warn_of_chart(const std::string& sentence, Console& console) {
  console.watch("chart").warn(sentence);
  console.finish();
}

}  // namespace

void try_save_chart(const std::string& path, const Chart& chart, Console& console) {
  try {
    save_chart(path, chart);
  } catch (const Error& error) {
    warn_of_chart(error.what(), console);
  }
}

void try_save_chart(const OutputSet& set, const std::string& name, const Chart& chart, Console& console) {
  try {
    save_chart(set.path(name), chart);
  } catch (const Error& error) {
    warn_of_chart(set.final_text(error.what()), console);
  }
}

}  // namespace holotrace
