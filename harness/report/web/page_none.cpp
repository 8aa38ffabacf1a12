#include "report/web/page.hpp"

namespace clothbench {

PageTemplate page_template() { return {}; }

std::string write_page(const std::filesystem::path& out, const std::vector<RunRecord>&, const Page&,
                       const PageTemplate&) {
  std::filesystem::remove(out / "index.html");  // an older run's page is not this report's
  return "The interactive page was left out: this build was made without it (CLOTHBENCH_WITH_PAGE).";
}

}  // namespace clothbench
