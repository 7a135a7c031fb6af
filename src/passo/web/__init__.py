"""HTTP and WebSocket interface of a printer, in a thread and a real-time event loop of its own."""
