# SPDX-License-Identifier: Apache-2.0
# The two tiers of tests (docs/maintainer/testing.md).
#
# The default tier runs the lists below and every test that tools/mutants names. The full tier runs all tests:
# CDE_FULL_TESTS=ON (tools/test --full) builds and finds them. A program without a list runs completely in the default
# tier: the programs of tests/numerics, tests/opencl, tests/oracle, tests/modules, tests/synthesis, and cde_wave_tests.

# ---- Tests of the default tier: GoogleTest filters per program (cde_NAME_tests), and exclusions ----

# The reference and the formats. tools/mutants adds tests of units.
set(CDE_DEFAULT_fp FpFormat.* FpReference.* ScalarOps.*)

# Cards: tests that need no other simulation models than tools/mutants needs.
set(CDE_DEFAULT_board BvhCache.* FpgaCard.* Cards/BvhCards.HardRays_EqualTheReference/cached SimulationModels.FileOfAnotherKey_IsRebuiltOnce SimulationModels.Fifo_IsNotRead SimulationModels.LastResortCacheAsLink_IsRefused SimulationModels.BuilderInputs_MustBeTrusted ModelShare.* CardChoice.Parameters_ReadBackEqual Checker.* Contract.* BvhDriver.ImpossibleConfigurations_AreRefused BvhForSolids.ImpossibleConfigurations_AreRefused WithoutEcc.*
  */ReferenceKnown.* FormatConfig.UnsupportedFormat_IsNamed FormatWords.* Registers.*)
set(CDE_DEFAULT_bus BusFaults.Names_ReadBackEqual PciBar.* PciConfig.* PciCardTest.Registers_IdentifyTheCard)
set(CDE_DEFAULT_pipe Moller.SingleCycleOperators_GiveTenCycles)
set(CDE_DEFAULT_pair PairFailure.*)

# Files, meshes, plans and messages.
set(CDE_DEFAULT_host *)
set(CDE_NOT_DEFAULT_host Plan.TooLargeScene_IsRefused)  # two minutes

# The command: every verb and every group of options, on the installed simulation models and few others.
set(CDE_DEFAULT_cli
  Accuracy.* AccuracyPage.* Advise.*
  Bench.QuickUnits_ReportPlausibleFigures Bench.UnknownSection_IsRefused Bundles.Deadline_IsNotPacked
  Cast.* CastFiles.* CastBvh.* Doctor.*
  Explain.Manual_ShowsThePrintedOutput Explain.InvalidUsage_IsRefused ExplainLine.* ExplainRecord.*
  FormatCli.Cast_RefusesUnsupportedFormats FormatCli.Scene_RefusesUnsupportedFormats PlantedBugsTable.*
  ModelBuild.SignalToTheCommand_EndsTheBuild RunFolders.* Outputs.* Streams.*
  CommandLine.* Devices.* Help.* JsonKeys.* MeshInputFiles.*
  InventoryCache.* Inventory.TextMarkdownAndUsage_AreCorrect
  Pages.Report_EqualsRunJson Pages.UnwritableReport_IsRefusedBeforeTheRun
  Query.* Ranks.DamagedJournal_IsNamed Ranks.ForeignJournal_IsRefused Ranks.ShardsOfACast_AddUpToTheWhole MpiRanks.Errors_ArePrintedOnce
  RunScene.* SceneBvh.MovingObjects_GiveTheBytesOfBruteForce TraceWindow.WindowOfAQuery_HoldsItsCycles TraceWindow.InvalidWindow_IsRefused Tutorial.*)
# Long tests, and tests that build a simulation model which no other test uses.
set(CDE_NOT_DEFAULT_cli
  Accuracy.MoreBits_HaveSmallerErrors AccuracyPage.WorstCase_RepeatsWithItsCommand
  Cast.BothArithmetics_GiveTheSameFile Cast.FaultyCard_IsFound Cast.MoreCards_GiveTheSameFile CastFiles.Algorithms_FindTheSameHits CastBvh.Watertight_EqualsReferenceAndBruteForce
  ExplainRecord.WrongUpdate_IsNamed ExplainRecord.MissedPair_IsListedAsMissing
  Query.MillionPairs_AreAnsweredInOrder Query.HalfSpaceOption_MakesThePlaneSolid Query.BothArithmetics_GiveTheSameAnswers Query.Iterations_SetTheCyclesOfACylinderPair Query.CandidateAxesOfLongWords_UseOneLane Query.FaultyPipe_IsFound Query.BoxRule_MissesTrianglesWithoutArea
  RunScene.BuiltCard_StandsIn RunScene.FaultyCard_IsFound RunScene.BusFaults_AreRetriedOrOneError RunScene.MixedScene_IsCheckedCompletely Streams.ClosedPipe_EndsQuietly)

# Transactions in the waves of a card. cde_wave_tests needs one simulation model and runs completely.
set(CDE_DEFAULT_wave_card TxCard.CardBehindPci_MatchesTheCardsCounters)

# Tests that are not GoogleTests run in the default tier, except these.
set(CDE_FULL_ONLY fp_cli.formats lint.rtl model.concurrent model.interrupted model.plain mpi.hosts mutate.faults netlist)

# ---- Functions that apply the lists ----

# Sets `out` to the tests of `program` that tools/mutants names, each as `FILTER [VARIABLE=VALUE ...]`.
function(cde_planted_tests program out)
  set(all "")
  file(GLOB tables CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/tools/mutants/*.txt)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${tables})
  foreach(table IN LISTS tables)
    file(STRINGS ${table} lines REGEX "^tests +${program} ")
    foreach(line IN LISTS lines)
      string(REGEX REPLACE "^tests +${program} +" "" line "${line}")
      string(REGEX REPLACE " +BUILD=[^ ]+" "" line "${line}")
      list(APPEND all "${line}")
    endforeach()
  endforeach()
  list(REMOVE_DUPLICATES all)
  set(${out} "${all}" PARENT_SCOPE)
endfunction()

# cde_discover_tests(cde_NAME_tests [LABELLED LABEL FILTER] PROPERTIES LABELS LABEL [TIMEOUT SECONDS] [ENVIRONMENT
# VARIABLE=VALUE ...])
# finds the tests of the tier. Tests that match FILTER also get LABEL. If the program has a list, only the full tier
# runs these.
function(cde_discover_tests target)
  cmake_parse_arguments(arg "" "" "LABELLED;PROPERTIES" ${ARGN})
  cmake_parse_arguments(arg "" "TIMEOUT" "LABELS;ENVIRONMENT" ${arg_PROPERTIES})
  string(REGEX REPLACE "^cde_(.*)_tests$" "\\1" program ${target})
  set(filters *)
  set(apart "")  # environment variables of their own
  if(DEFINED CDE_DEFAULT_${program} AND NOT CDE_FULL_TESTS)
    set(filters ${CDE_DEFAULT_${program}})
    cde_planted_tests(${program} planted)
    foreach(test IN LISTS planted)
      if(test MATCHES "^([^ ]+) +(.+)$")
        string(REPLACE " " "_" group "${CMAKE_MATCH_2}")
        list(APPEND apart ${group})
        list(APPEND filters_${group} ${CMAKE_MATCH_1})
        string(REPLACE " " ";" variables_${group} "${CMAKE_MATCH_2}")
      else()
        list(APPEND filters ${test})
      endif()
    endforeach()
    list(REMOVE_DUPLICATES filters)
    list(REMOVE_DUPLICATES apart)
  endif()
  list(JOIN filters ":" filter)
  set(without "")
  if(NOT CDE_FULL_TESTS)
    set(without ${CDE_NOT_DEFAULT_${program}})
  endif()
  if(arg_LABELLED)
    list(GET arg_LABELLED 0 label)
    list(GET arg_LABELLED 1 labelled)
    list(APPEND without ${labelled})
    if(CDE_FULL_TESTS OR NOT DEFINED CDE_DEFAULT_${program})
      cde_discover(${target} "${labelled}" "" "${arg_LABELS};${label}" "${arg_TIMEOUT}" "${arg_ENVIRONMENT}")
    endif()
  endif()
  if(without)
    list(JOIN without ":" without)
    string(APPEND filter "-${without}")
  endif()
  cde_discover(${target} "${filter}" "" "${arg_LABELS}" "${arg_TIMEOUT}" "${arg_ENVIRONMENT}")
  foreach(group IN LISTS apart)
    list(JOIN filters_${group} ":" filter)
    cde_discover(${target} "${filter}" "/${group}" "${arg_LABELS}" "${arg_TIMEOUT}" "${arg_ENVIRONMENT};${variables_${group}}")
  endforeach()
  if(CDE_TEST_HEADERS)
    target_precompile_headers(${target} REUSE_FROM ${CDE_TEST_HEADERS})
  endif()
endfunction()

# gtest_discover_tests cannot pass lists as values of properties. ctest reads a second file that sets them.
function(cde_discover target filter suffix labels timeout environment)
  string(MAKE_C_IDENTIFIER "${target}${suffix}_${labels}" list)
  gtest_discover_tests(${target} TEST_FILTER "${filter}" TEST_SUFFIX "${suffix}" TEST_LIST ${list} DISCOVERY_TIMEOUT 60)
  set(properties "LABELS [[${labels}]]")
  foreach(property timeout environment)
    if(${property})
      string(TOUPPER ${property} name)
      string(APPEND properties " ${name} [[${${property}}]]")
    endif()
  endforeach()
  set(file ${CMAKE_CURRENT_BINARY_DIR}/${list}.cmake)
  file(CONFIGURE OUTPUT ${file} CONTENT "if(${list})\n  set_tests_properties(\${${list}} PROPERTIES ${properties})\nendif()\n" @ONLY)
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${file})
endfunction()

# cde_needs(TARGET MODEL ...) builds the models of the tier before the target.
function(cde_needs target)
  foreach(model IN LISTS ARGN)
    get_target_property(full ${model} CDE_FULL_TIER)
    if(CDE_FULL_TESTS OR NOT full)
      add_dependencies(${target} ${model})
    endif()
  endforeach()
endfunction()

# cde_in_tier(TEST RESULT) tells whether a test that is not a GoogleTest runs in this tier. tools/test counts the
# others.
file(WRITE ${PROJECT_BINARY_DIR}/full_tests.txt "")
function(cde_in_tier test result)
  if(NOT CDE_FULL_TESTS AND test IN_LIST CDE_FULL_ONLY)
    file(APPEND ${PROJECT_BINARY_DIR}/full_tests.txt "${test}\n")
    set(${result} OFF PARENT_SCOPE)
  else()
    set(${result} ON PARENT_SCOPE)
  endif()
endfunction()

# Checks that simulation models which tools/mutants builds belong to the default tier.
function(cde_check_planted_models)
  file(GLOB tables ${PROJECT_SOURCE_DIR}/tools/mutants/*.txt)
  foreach(table IN LISTS tables)
    file(STRINGS ${table} lines REGEX "^tests .* BUILD=")
    foreach(line IN LISTS lines)
      string(REGEX REPLACE "^.* BUILD=([^ ]+).*$" "\\1" name "${line}")
      if(NOT TARGET ${name})
        message(FATAL_ERROR "${table} names the simulation model ${name}, which no CMakeLists.txt has")
      endif()
      get_target_property(full ${name} CDE_FULL_TIER)
      if(full)
        message(FATAL_ERROR "${table} names the simulation model ${name}, which only the full tier builds: remove FULL from its cde_add_model")
      endif()
    endforeach()
  endforeach()
endfunction()
