// A plug-in of GCC that runs before its pass `tsan`, which announces assignments and nothing else.
// What touches memory in another form becomes an assignment or a call here:
//
//   memory = f(x)          a small class that comes back in registers, or a large one whose place f
//                          is told: the call fills a temporary, an assignment follows
//   f(memory)              a class passed by value: an assignment to a temporary goes before
//   __builtin_memcpy, ...  what GCC may expand in place: a call of the C library's function, which
//                          the runtime redirects and announces
//   the parts of a         are fields of which GCC says that nobody may ask for their address, and
//   pointer to member      which are left out for that: not any more
//
// Classes that must not be copied (TREE_ADDRESSABLE) are made and read by instrumented code through
// a pointer, and need nothing. Local variables stay as they are: nobody watches stacks.

// In the order in which they need each other.
// clang-format off
#include <gcc-plugin.h>
#include <tree.h>
#include <basic-block.h>
#include <context.h>
#include <gimple-expr.h>
#include <gimple.h>
#include <builtins.h>
#include <cfghooks.h>
#include <diagnostic-core.h>
#include <gimple-iterator.h>
#include <gimple-ssa.h>
#include <gimplify.h>
#include <plugin-version.h>
#include <ssa.h>
#include <stringpool.h>
#include <tree-cfg.h>
#include <tree-dfa.h>
#include <tree-pass.h>
#include <attribs.h>
#include <asan.h>
// clang-format on

// GCC asks for this name.
// NOLINTNEXTLINE(readability-identifier-naming)
int plugin_is_GPL_compatible;

namespace {

/// Whether `memory` may be seen by others than this function.
bool is_foreign(tree memory) {
  const tree base = get_base_address(memory);
  return base == NULL_TREE || !auto_var_p(base);
}

bool is_foreign_pointer(tree pointer) {
  return TREE_CODE(pointer) != ADDR_EXPR || is_foreign(TREE_OPERAND(pointer, 0));
}

/// The C library's function that does what `builtin` does; null for what is no access or is never
/// expanded in place.
const char* function_of(built_in_function builtin) {
  switch (builtin) {
    case BUILT_IN_MEMCPY:
      return "memcpy";
    case BUILT_IN_MEMMOVE:
      return "memmove";
    case BUILT_IN_MEMPCPY:
      return "mempcpy";
    case BUILT_IN_MEMSET:
      return "memset";
    case BUILT_IN_BZERO:
      return "bzero";
    case BUILT_IN_MEMCMP:
    case BUILT_IN_MEMCMP_EQ:
    case BUILT_IN_BCMP:
      return "memcmp";
    case BUILT_IN_MEMCHR:
      return "memchr";
    case BUILT_IN_STRLEN:
      return "strlen";
    case BUILT_IN_STRNLEN:
      return "strnlen";
    case BUILT_IN_STRCMP:
    case BUILT_IN_STRCMP_EQ:
      return "strcmp";
    case BUILT_IN_STRNCMP:
    case BUILT_IN_STRNCMP_EQ:
      return "strncmp";
    case BUILT_IN_STRCPY:
      return "strcpy";
    case BUILT_IN_STPCPY:
      return "stpcpy";
    case BUILT_IN_STRNCPY:
      return "strncpy";
    case BUILT_IN_STRCAT:
      return "strcat";
    case BUILT_IN_STRNCAT:
      return "strncat";
    case BUILT_IN_INDEX:
    case BUILT_IN_STRCHR:
      return "strchr";
    case BUILT_IN_RINDEX:
    case BUILT_IN_STRRCHR:
      return "strrchr";
    case BUILT_IN_STRSTR:
      return "strstr";
    default:
      return nullptr;
  }
}

void call_the_library(gcall* call) {
  if (!gimple_call_builtin_p(call, BUILT_IN_NORMAL)) return;
  const tree builtin = gimple_call_fndecl(call);
  const char* const name = function_of(DECL_FUNCTION_CODE(builtin));
  if (name == nullptr) return;
  bool foreign = false;
  for (unsigned i = 0; i < gimple_call_num_args(call); ++i) {
    const tree argument = gimple_call_arg(call, i);
    foreign = foreign || (POINTER_TYPE_P(TREE_TYPE(argument)) && is_foreign_pointer(argument));
  }
  if (!foreign) return;
  const tree function = build_fn_decl(name, TREE_TYPE(builtin));
  TREE_NOTHROW(function) = 1;
  gimple_call_set_fndecl(call, function);
  gimple_call_set_fntype(call, TREE_TYPE(builtin));
  update_stmt(call);
}

void copy_arguments(gimple_stmt_iterator* at, gcall* call) {
  for (unsigned i = 0; i < gimple_call_num_args(call); ++i) {
    const tree argument = gimple_call_arg(call, i);
    const tree type = TREE_TYPE(argument);
    if (is_gimple_reg_type(type) || TREE_ADDRESSABLE(type) || !is_gimple_lvalue(argument) ||
        !is_foreign(argument))
      continue;
    const tree copy = create_tmp_var(type, "irt_argument");
    gimple* const assignment = gimple_build_assign(copy, unshare_expr(argument));
    gimple_set_location(assignment, gimple_location(call));
    gsi_insert_before(at, assignment, GSI_SAME_STMT);
    gimple_call_set_arg(call, i, copy);
    update_stmt(call);
  }
}

void assign_result(gimple_stmt_iterator* at, gcall* call) {
  const tree place = gimple_call_lhs(call);
  if (place == NULL_TREE || is_gimple_reg(place) || !is_foreign(place)) return;
  const tree type = TREE_TYPE(place);
  if (TREE_ADDRESSABLE(type)) return;
  const tree result =
      is_gimple_reg_type(type) ? make_ssa_name(type) : create_tmp_var(type, "irt_result");
  gimple* const assignment = gimple_build_assign(place, result);
  gimple_set_location(assignment, gimple_location(call));
  gimple_call_set_lhs(call, result);
  if (TREE_CODE(result) == SSA_NAME) SSA_NAME_DEF_STMT(result) = call;
  update_stmt(call);
  if (!stmt_ends_bb_p(call)) {
    gsi_insert_after(at, assignment, GSI_NEW_STMT);
    return;
  }
  // What may throw is the last statement of its block.
  if (edge next = find_fallthru_edge(gimple_bb(call)->succs)) gsi_insert_on_edge(next, assignment);
}

void make_addressable(tree memory) {
  for (; handled_component_p(memory); memory = TREE_OPERAND(memory, 0)) {
    if (TREE_CODE(memory) != COMPONENT_REF) continue;
    const tree field = TREE_OPERAND(memory, 1);
    if (!DECL_BIT_FIELD(field)) DECL_NONADDRESSABLE_P(field) = 0;
  }
}

const pass_data description = {GIMPLE_PASS,
                               "irt_announcer",
                               OPTGROUP_NONE,
                               TV_NONE,
                               PROP_cfg,
                               0,
                               0,
                               0,
                               TODO_update_ssa_only_virtuals | TODO_cleanup_cfg};

class Announcer final : public gimple_opt_pass {
 public:
  explicit Announcer(gcc::context* context) : gimple_opt_pass(description, context) {}

  opt_pass* clone() override { return new Announcer(m_ctxt); }
  bool gate(function*) override { return sanitize_flags_p(SANITIZE_THREAD); }

  unsigned execute(function* code) override {
    basic_block block;
    FOR_EACH_BB_FN(block, code) {
      for (gimple_stmt_iterator at = gsi_start_bb(block); !gsi_end_p(at); gsi_next(&at)) {
        if (gimple_assign_single_p(gsi_stmt(at))) {
          make_addressable(gimple_assign_lhs(gsi_stmt(at)));
          make_addressable(gimple_assign_rhs1(gsi_stmt(at)));
        }
        auto* const call = dyn_cast<gcall*>(gsi_stmt(at));
        if (call == nullptr || gimple_call_internal_p(call)) continue;
        call_the_library(call);
        copy_arguments(&at, call);
        assign_result(&at, call);
      }
    }
    gsi_commit_edge_inserts();
    return 0;
  }
};

}  // namespace

// NOLINTNEXTLINE(readability-identifier-naming)
int plugin_init(plugin_name_args* arguments, plugin_gcc_version* compiler) {
  if (!plugin_default_version_check(compiler, &gcc_version)) {
    error("irt: the plug-in %s was built for another version of GCC", arguments->base_name);
    return 1;
  }
  // With and without optimisation.
  for (const char* tsan : {"tsan", "tsan0"}) {
    register_pass_info before{new Announcer(g), tsan, 1, PASS_POS_INSERT_BEFORE};
    register_callback(arguments->base_name, PLUGIN_PASS_MANAGER_SETUP, nullptr, &before);
  }
  return 0;
}
