"""The rules of the conformance suite, one module for each group."""
