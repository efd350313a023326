"""What users call: run, status, tables, queries, logs, what lies in the store."""
