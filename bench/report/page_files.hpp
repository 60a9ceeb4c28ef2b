/// The files of the page that a browser reads, as they stand in this directory.
#pragma once

namespace irt::report {

extern const char* const page_html;
extern const char* const page_css;
extern const char* const plots_js;
extern const char* const page_js;

}  // namespace irt::report
